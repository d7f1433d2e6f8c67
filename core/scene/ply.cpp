#include <bit>
#include <cstring>

#include "core/base/error.h"
#include "core/scene/mesh_io.h"
#include "core/scene/text_scanner.h"

namespace ulam {
namespace {

struct ScalarType {
    std::string_view name, alias;
    size_t size;
    double (*fromBytes)(const char*, bool swap);
};

template <class T>
double fromBytes(const char* bytes, bool swap) {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes, sizeof(T));
    if (swap) std::reverse(raw.begin(), raw.end());
    return double(std::bit_cast<T>(raw));
}

constexpr std::array<ScalarType, 8> kTypes{{{"char", "int8", 1, fromBytes<int8_t>},
                                            {"uchar", "uint8", 1, fromBytes<uint8_t>},
                                            {"short", "int16", 2, fromBytes<int16_t>},
                                            {"ushort", "uint16", 2, fromBytes<uint16_t>},
                                            {"int", "int32", 4, fromBytes<int32_t>},
                                            {"uint", "uint32", 4, fromBytes<uint32_t>},
                                            {"float", "float32", 4, fromBytes<float>},
                                            {"double", "float64", 8, fromBytes<double>}}};

struct PlyProperty {
    std::string_view name;
    const ScalarType* type;
    const ScalarType* lengthType = nullptr;  // of a list
};

struct Element {
    std::string_view name;
    uint64_t count;
    std::vector<PlyProperty> properties;

    std::optional<size_t> find(std::initializer_list<std::string_view> names) const {
        for (size_t i = 0; i < properties.size(); ++i)
            for (const std::string_view wanted : names)
                if (properties[i].name == wanted) return i;
        return std::nullopt;
    }
};

class PlyReader {
public:
    PlyReader(std::string_view bytes, std::string_view name) : name_(name), size_(bytes.size()), rest_(bytes) {}

    Mesh read();

private:
    enum class Format { Ascii, Little, Big };

    template <class... Arguments>
    [[noreturn]] void error(fmt::format_string<Arguments...> format, Arguments&&... arguments) const {
        fail(ExitCode::InvalidConfig, "{}, byte {}: {}", name_, size_ - rest_.size(),
             fmt::format(format, std::forward<Arguments>(arguments)...));
    }

    const ScalarType& type(std::string_view name) const;
    void header();
    void addProperty(std::string_view line);
    double scalar(const ScalarType& type);
    /// Fails where so many values cannot be in what is left of the file.
    void checkRoom(uint64_t count, size_t bytesEach, std::string_view what) const;
    size_t smallestSize(const Element& element) const;
    /// One row: a number for each property; of lists their lengths, and in `list` the content of the wanted one.
    void row(const Element& element, std::optional<size_t> wantedList);
    void vertices(const Element& element);
    bool isPlainTriangles(const Element& element) const;
    bool plainTriangle();
    void faces(const Element& element);

    static constexpr size_t kPlainTriangle = 1 + 3 * sizeof(uint32_t);

    std::string_view name_;
    size_t size_;
    std::string_view rest_;
    Format format_ = Format::Ascii;
    std::vector<Element> elements_;
    std::vector<double> row_, list_;
    Mesh mesh_;
};

const ScalarType& PlyReader::type(std::string_view name) const {
    for (const ScalarType& t : kTypes)
        if (t.name == name || t.alias == name) return t;
    error("\"{}\" is no type of a property", name.substr(0, 40));
}

void PlyReader::addProperty(std::string_view line) {
    if (elements_.empty()) error("a property stands before the first element");
    PlyProperty property{};
    std::string_view word = nextWord(line);
    if (word == "list") {
        property.lengthType = &type(nextWord(line));
        word = nextWord(line);
    }
    property.type = &type(word);
    property.name = nextWord(line);
    elements_.back().properties.push_back(property);
}

void PlyReader::header() {
    if (nextWord(rest_, isBlankOrLineEnd) != "ply") error("a PLY file begins with \"ply\"");
    nextLine(rest_);
    while (true) {
        if (rest_.empty()) error("the header has no end_header");
        std::string_view line = nextLine(rest_);
        const std::string_view keyword = nextWord(line);
        if (keyword == "end_header") return;
        if (keyword == "format") {
            const std::string_view format = nextWord(line);
            if (format == "ascii")
                format_ = Format::Ascii;
            else if (format == "binary_little_endian")
                format_ = Format::Little;
            else if (format == "binary_big_endian")
                format_ = Format::Big;
            else
                error("expected ascii, binary_little_endian or binary_big_endian, found \"{}\"", format.substr(0, 40));
        } else if (keyword == "element") {
            const std::string_view name = nextWord(line), count = nextWord(line);
            const auto number = toNumber<uint64_t>(count);
            if (!number) error("\"{}\" is no count of elements", count.substr(0, 40));
            elements_.push_back({name, *number, {}});
        } else if (keyword == "property") {
            addProperty(line);
        }
    }
}

double PlyReader::scalar(const ScalarType& t) {
    if (format_ == Format::Ascii) {
        const std::string_view word = nextWord(rest_, isBlankOrLineEnd);
        const auto value = toNumber<double>(word);
        if (!value) error("expected a number, found \"{}\"", word.substr(0, 40));
        return *value;
    }
    if (rest_.size() < t.size) error("the file ends in the middle of its data");
    const double value =
        t.fromBytes(rest_.data(), (format_ == Format::Big) == (std::endian::native == std::endian::little));
    rest_.remove_prefix(t.size);
    return value;
}

void PlyReader::checkRoom(uint64_t count, size_t bytesEach, std::string_view what) const {
    if (bytesEach > 0 && count > rest_.size() / bytesEach)
        error("the file is too short for {} {}", count, what.substr(0, 40));
}

size_t PlyReader::smallestSize(const Element& element) const {
    size_t size = 0;
    for (const PlyProperty& p : element.properties)
        size += format_ == Format::Ascii ? 1 : p.lengthType ? p.lengthType->size : p.type->size;
    return size;
}

void PlyReader::row(const Element& element, std::optional<size_t> wantedList) {
    row_.clear();
    for (size_t i = 0; i < element.properties.size(); ++i) {
        const PlyProperty& property = element.properties[i];
        row_.push_back(scalar(property.lengthType ? *property.lengthType : *property.type));
        if (!property.lengthType) continue;
        const double length = row_.back();
        if (!(length >= 0 && length <= 4294967295.0 && length == std::floor(length)))
            error("{} is no length of a list", length);
        checkRoom(uint64_t(length), format_ == Format::Ascii ? 1 : property.type->size, "list entries");
        if (i == wantedList) list_.clear();
        for (uint64_t k = 0; k < uint64_t(length); ++k) {
            const double value = scalar(*property.type);
            if (i == wantedList) list_.push_back(value);
        }
    }
}

void PlyReader::vertices(const Element& element) {
    std::array<std::optional<size_t>, 8> at{element.find({"x"}),
                                            element.find({"y"}),
                                            element.find({"z"}),
                                            element.find({"nx"}),
                                            element.find({"ny"}),
                                            element.find({"nz"}),
                                            element.find({"u", "s", "texture_u"}),
                                            element.find({"v", "t", "texture_v"})};
    if (!at[0] || !at[1] || !at[2]) error("the vertices have no properties x, y and z");
    const bool hasNormals = at[3] && at[4] && at[5], hasTexcoords = at[6] && at[7];
    const auto value = [&](size_t i) { return float(row_[*at[i]]); };
    // checkRoom() has seen that the file is long enough: at least a byte a number.
    mesh_.positions.reserve(element.count + 1);
    if (hasNormals) mesh_.normals.reserve(element.count);
    if (hasTexcoords) mesh_.texcoords.reserve(element.count);
    for (uint64_t i = 0; i < element.count; ++i) {
        row(element, std::nullopt);
        mesh_.positions.emplace_back(value(0), value(1), value(2));
        if (hasNormals) mesh_.normals.emplace_back(value(3), value(4), value(5));
        if (hasTexcoords) mesh_.texcoords.emplace_back(value(6), value(7));
    }
}

/// Nothing but a list of 32-bit numbers, its length in a byte, as this machine has them: as most files are.
bool PlyReader::isPlainTriangles(const Element& element) const {
    const bool native = format_ == (std::endian::native == std::endian::little ? Format::Little : Format::Big);
    if (!native || element.properties.size() != 1 || !element.properties[0].lengthType) return false;
    const PlyProperty& list = element.properties[0];
    return list.lengthType->size == 1 && (list.type->name == "int" || list.type->name == "uint");
}

/// Reads a face of three corners; leaves any other one, and damaged ones, for row().
bool PlyReader::plainTriangle() {
    if (rest_.size() < kPlainTriangle || rest_[0] != 3) return false;
    std::array<uint32_t, 3> triangle;
    std::memcpy(triangle.data(), rest_.data() + 1, sizeof triangle);
    // Negative, if the numbers have a sign; beyond any mesh if not.
    if ((triangle[0] | triangle[1] | triangle[2]) >> 31) return false;
    mesh_.triangles.push_back(triangle);
    rest_.remove_prefix(kPlainTriangle);
    return true;
}

void PlyReader::faces(const Element& element) {
    const auto list = element.find({"vertex_indices", "vertex_index"});
    if (!list || !element.properties[*list].lengthType) error("the faces have no list vertex_indices");
    const auto index = [&](size_t i) {
        if (!(list_[i] >= 0 && list_[i] <= 4294967295.0 && list_[i] == std::floor(list_[i])))
            error("{} is no vertex of a face", list_[i]);
        return uint32_t(list_[i]);
    };
    const bool plain = isPlainTriangles(element);
    if (plain) mesh_.triangles.reserve(std::min<uint64_t>(element.count, rest_.size() / kPlainTriangle));
    for (uint64_t i = 0; i < element.count; ++i) {
        if (plain && plainTriangle()) continue;
        row(element, list);
        if (list_.size() < 3) error("a face has {} corners, at least 3 are needed", list_.size());
        for (size_t k = 2; k < list_.size(); ++k) mesh_.triangles.push_back({index(0), index(k - 1), index(k)});
    }
}

Mesh PlyReader::read() {
    header();
    for (const Element& element : elements_) {
        // Before anything is allocated or looped over.
        checkRoom(element.count, smallestSize(element), element.name);
        if (element.name == "vertex") {
            if (!mesh_.positions.empty()) error("the vertices stand in two elements");
            vertices(element);
        } else if (element.name == "face") {
            faces(element);
        } else if (!element.properties.empty()) {
            for (uint64_t i = 0; i < element.count; ++i) row(element, std::nullopt);
        }
    }
    return std::move(mesh_);
}

}  // namespace

Mesh readPly(std::string_view bytes, std::string_view name) {
    return PlyReader(bytes, name).read();
}

}  // namespace ulam
