#include "core/render/checkpoint.h"

#include <zlib.h>

#include <cstdio>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/config/difference.h"

namespace ulam {
namespace {

uint32_t checksum(std::string_view bytes) {
    return uint32_t(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::string firstLine(unsigned long long bytes, unsigned long long crc) {
    return fmt::format("ulam checkpoint {} {} {}\n", kCheckpointFormat, bytes, crc);
}

}  // namespace

void writeCheckpoint(const CheckpointPlan& plan, const std::string& state) {
    const std::string identity = plan.identity.dump() + "\n";
    const auto crc = uint32_t(crc32_combine(checksum(identity), checksum(state), z_off_t(state.size())));
    const std::string line = firstLine(identity.size() + state.size(), crc);
    const std::string_view parts[] = {line, identity, state};
    writeFileAtomically(plan.file, parts);
}

std::string readCheckpoint(const CheckpointPlan& plan) {
    std::string bytes = readFile(plan.file);
    const std::string name = plan.file.string();
    const size_t lineEnd = bytes.find('\n');
    int format = 0;
    unsigned long long size = 0, crc = 0;
    if (lineEnd == std::string::npos ||
        std::sscanf(bytes.substr(0, lineEnd).c_str(), "ulam checkpoint %d %llu %llu", &format, &size, &crc) != 3)
        fail(ExitCode::InvalidConfig, "{} is no checkpoint", name);
    if (format != kCheckpointFormat)
        fail(ExitCode::InvalidConfig, "{} has format {} of checkpoints, expected {}: it was written by another version of the program",
             name, format, kCheckpointFormat);
    const std::string_view rest = std::string_view(bytes).substr(lineEnd + 1);
    if (rest.size() != size || checksum(rest) != crc || !bytes.starts_with(firstLine(size, crc)))
        fail(ExitCode::InvalidConfig, "{} is damaged: its length or checksum is not what was written", name);
    const size_t identityEnd = rest.find('\n');
    const Json identity = Json::parse(rest.substr(0, identityEnd));
    if (identity != plan.identity)
        fail(ExitCode::InvalidConfig, "{} belongs to another run: {}", name, firstDifference(identity, plan.identity, "the checkpoint"));
    bytes.erase(0, lineEnd + 1 + identityEnd + 1);  // in place: a state may be most of the memory
    return bytes;
}

bool isCheckpointOf(const CheckpointPlan& plan) {
    try {
        readCheckpoint(plan);
        return true;
    } catch (const Error&) {
        return false;
    }
}

}  // namespace ulam
