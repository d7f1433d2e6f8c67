#include "core/scene/mesh_io.h"

#include "core/base/error.h"
#include "core/config/suggest.h"

#include <zlib.h>

#include <array>
#include <bit>
#include <cstring>
#include <vector>

namespace ulam {
namespace {

static_assert(std::endian::native == std::endian::little, "the format's numbers are read as they lie in memory");

constexpr uint32_t kHasNormals = 0x1, kHasTexcoords = 0x2, kHasColors = 0x8, kFaceNormals = 0x10, kSingle = 0x1000, kDouble = 0x2000;

/// One mesh's zlib stream, inflated piece by piece.
class Inflater {
public:
    Inflater(std::string_view compressed, std::string_view name) : name_(name) {
        stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(compressed.data()));
        stream_.avail_in = uInt(std::min<size_t>(compressed.size(), ~0u));
        if (inflateInit(&stream_) != Z_OK) throw std::bad_alloc();
    }
    ~Inflater() { inflateEnd(&stream_); }
    Inflater(const Inflater&) = delete;
    Inflater& operator=(const Inflater&) = delete;

    void read(void* target, size_t bytes) {
        auto* out = static_cast<Bytef*>(target);
        while (bytes > 0) {
            stream_.next_out = out;
            stream_.avail_out = uInt(std::min<size_t>(bytes, 1u << 30));
            const uInt room = stream_.avail_out;
            const int state = inflate(&stream_, Z_NO_FLUSH);
            const size_t got = room - stream_.avail_out;
            out += got;
            bytes -= got;
            if (bytes > 0 && (state != Z_OK || got == 0)) fail(ExitCode::InvalidConfig, "{}: the mesh's data end early or are damaged", printable(name_, 200));
        }
    }
    template <class T>
    T value() {
        T v;
        read(&v, sizeof v);
        return v;
    }
    /// What is left of the stream can become no more than this (zlib's largest ratio, RFC 1951).
    uint64_t most() const { return uint64_t(stream_.avail_in) * 1032; }

private:
    std::string_view name_;
    z_stream stream_{};
};

class SerializedReader {
public:
    SerializedReader(std::string_view bytes, std::string_view name) : bytes_(bytes), name_(name) {}

    SerializedMesh read(int index) {
        const auto [begin, end] = range(index);
        const uint16_t version = at<uint16_t>(begin + 2);
        if (at<uint16_t>(begin) != 0x041C || (version != 3 && version != 4))
            error("there is no mesh of version 3 or 4 at byte {}", begin);
        Inflater data(bytes_.substr(begin + 4, end - begin - 4), name_);
        const auto flags = data.value<uint32_t>();
        if (((flags & kSingle) != 0) == ((flags & kDouble) != 0)) error("the mesh's numbers are of neither or of both precisions");
        if (version == 4)
            while (data.value<char>() != 0) {}
        const auto vertices = data.value<uint64_t>(), triangles = data.value<uint64_t>();
        const size_t size = (flags & kDouble) ? 8 : 4;
        const uint64_t perVertex = size * (3 + ((flags & kHasNormals) ? 3 : 0) + ((flags & kHasTexcoords) ? 2 : 0) + ((flags & kHasColors) ? 3 : 0));
        if (vertices > data.most() / perVertex || triangles > data.most() / 12)
            error("the file is too short for {} vertices and {} triangles", vertices, triangles);
        if (vertices > 0xffffffffull) error("a mesh of {} vertices is too large", vertices);

        SerializedMesh result;
        result.faceNormals = (flags & kFaceNormals) != 0;
        Mesh& mesh = result.mesh;
        mesh.positions = points<Vec3f>(data, vertices, size);
        if (flags & kHasNormals) mesh.normals = points<Vec3f>(data, vertices, size);
        if (flags & kHasTexcoords) mesh.texcoords = points<Vec2f>(data, vertices, size);
        if (flags & kHasColors) points<Vec3f>(data, vertices, size);
        readAll(data, mesh.triangles, triangles);
        return result;
    }

private:
    template <class... Arguments>
    [[noreturn]] void error(fmt::format_string<Arguments...> format, Arguments&&... arguments) const {
        fail(ExitCode::InvalidConfig, "{}: {}", printable(name_, 200), fmt::format(format, std::forward<Arguments>(arguments)...));
    }

    template <class T>
    T at(uint64_t offset) const {
        if (offset > bytes_.size() || bytes_.size() - offset < sizeof(T)) error("the file ends early, at byte {}", bytes_.size());
        T value;
        std::memcpy(&value, bytes_.data() + offset, sizeof value);
        return value;
    }

    /// Where a mesh lies. The file ends with their number, and before it where each begins: in 8 bytes, in files of version
    /// 3 in 4.
    std::pair<uint64_t, uint64_t> range(int index) const {
        const auto version = at<uint16_t>(2);
        const uint64_t width = version == 3 ? 4 : 8;
        const uint64_t count = bytes_.size() >= 8 ? at<uint32_t>(bytes_.size() - 4) : 0;
        if (count == 0 || count > (bytes_.size() - 4) / width) error("the file does not end with a list of its meshes");
        if (index < 0 || uint64_t(index) >= count) error("the file has {} meshes, there is no number {} (counted from 0)", count, index);
        const uint64_t list = bytes_.size() - 4 - count * width;
        const auto begin = [&](uint64_t i) { return width == 4 ? at<uint32_t>(list + 4 * i) : at<uint64_t>(list + 8 * i); };
        const uint64_t first = begin(uint64_t(index)), last = uint64_t(index) + 1 < count ? begin(uint64_t(index) + 1) : list;
        if (first > list || last > list || last < first + 4) error("the list of meshes places number {} outside of the file", index);
        return {first, last};
    }

    /// Read piece by piece, so that a small file that promises much costs little: memory grows only as data come.
    template <class T>
    static void readAll(Inflater& data, std::vector<T>& values, uint64_t count) {
        constexpr uint64_t kPiece = 1 << 16;
        while (values.size() < count) {
            const size_t have = values.size(), more = size_t(std::min(kPiece, count - have));
            // Doubling would leave up to half of the room unused; the last step takes what is needed.
            if (have + more > values.capacity()) values.reserve(size_t(std::min(count + 1, 2 * uint64_t(have + more))));
            values.resize(have + more);
            data.read(&values[have], more * sizeof(T));
        }
    }
    template <class P>
    static std::vector<P> points(Inflater& data, uint64_t count, size_t size) {
        constexpr int kComponents = int(sizeof(P) / sizeof(float));
        std::vector<P> result;
        if (size == 4) {
            readAll(data, result, count);
            return result;
        }
        std::array<double, kComponents> wide;
        for (uint64_t i = 0; i < count; ++i) {
            data.read(wide.data(), sizeof wide);
            P& point = result.emplace_back();
            for (int k = 0; k < kComponents; ++k) point[k] = float(wide[size_t(k)]);
        }
        return result;
    }

    std::string_view bytes_, name_;
};

}  // namespace

SerializedMesh readSerialized(std::string_view bytes, std::string_view name, int index) { return SerializedReader(bytes, name).read(index); }

}  // namespace ulam
