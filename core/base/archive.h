#pragma once
// Values as bytes and back, for checkpoints. A type says once what it consists of, and the same function writes and
// reads it:
//
//     template <class Archive>
//     void archive(Archive& a) { a(position, weight, samples); }
//
// Bytes are those of this machine's memory; nothing is aligned or tagged.

#include "core/base/vector.h"

#include <array>
#include <cstring>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace ulam {

/// Types whose bytes are their value.
template <class T>
inline constexpr bool kPlain = std::is_arithmetic_v<T> || std::is_enum_v<T>;
template <class T>
inline constexpr bool kPlain<Imath::Vec2<T>> = true;
template <class T>
inline constexpr bool kPlain<Imath::Vec3<T>> = true;
template <class T>
inline constexpr bool kPlain<Imath::Color3<T>> = true;
template <class T, size_t N>
inline constexpr bool kPlain<std::array<T, N>> = kPlain<T>;

/// What writer and reader share: taking values apart.
template <class Derived>
class Archive {
public:
    template <class... T>
    void operator()(T&... values) {
        (one(values), ...);
    }

private:
    Derived& self() { return static_cast<Derived&>(*this); }

    template <class T>
    void one(T& value) {
        if constexpr (kPlain<T>) self().bytes(&value, sizeof value);
        else value.archive(self());
    }
    template <class T, size_t N>
    void one(std::array<T, N>& values) {
        if constexpr (kPlain<T>) self().bytes(values.data(), sizeof values);
        else
            for (T& value : values) one(value);
    }
    template <class T, class Allocator>
    void one(std::vector<T, Allocator>& values) {
        values.resize(self().count(values.size(), kPlain<T> ? sizeof(T) : 1));
        if constexpr (kPlain<T>) self().bytes(values.data(), values.size() * sizeof(T));
        else
            for (T& value : values) one(value);
    }
    void one(std::string& text) {
        text.resize(self().count(text.size(), 1));
        self().bytes(text.data(), text.size());
    }
    template <class T>
    void one(std::optional<T>& value) {
        bool present = value.has_value();
        one(present);
        if (present && !value) value.emplace();
        if (!present) value.reset();
        if (value) one(*value);
    }
    template <class Key, class T>
    void one(std::map<Key, T>& values) {
        std::vector<Key> keys;
        for (const auto& [key, value] : values) keys.push_back(key);
        one(keys);
        for (const Key& key : keys) one(values[key]);
    }
};

class ByteWriter : public Archive<ByteWriter> {
public:
    /// What has been written.
    std::string text;

    void bytes(const void* data, size_t size) { text.append(static_cast<const char*>(data), size); }
    size_t count(size_t elements, size_t) {
        bytes(&elements, sizeof elements);
        return elements;
    }
};

/// Throws std::length_error where bytes are missing.
class ByteReader : public Archive<ByteReader> {
public:
    explicit ByteReader(std::string_view text) : left_(text) {}

    bool atEnd() const { return left_.empty(); }
    void bytes(void* data, size_t size) {
        need(size);
        if (size > 0) std::memcpy(data, left_.data(), size);
        left_.remove_prefix(size);
    }
    /// Of a list: refuses a number of elements that cannot follow, before room for them is made.
    size_t count(size_t, size_t elementBytes) {
        size_t elements = 0;
        bytes(&elements, sizeof elements);
        if (elements > left_.size() / elementBytes) need(left_.size() + 1);
        return elements;
    }

private:
    void need(size_t size) const {
        if (size > left_.size()) throw std::length_error("a state ends too early");
    }

    std::string_view left_;
};

/// The bytes of one value.
template <class T>
std::string bytesOf(const T& value) {
    ByteWriter writer;
    writer(const_cast<T&>(value));  // a writer changes nothing; what a type consists of is written once for both
    return std::move(writer.text);
}

}  // namespace ulam
