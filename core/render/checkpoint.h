#pragma once
// The state of an unfinished render as a file: enough to go on as if it had never been interrupted, to the last bit.
//
// A line "ulam checkpoint FORMAT BYTES CRC32", then the identity as one line of JSON, then the state (archive.h). BYTES and
// CRC32 (zlib's) are of all that follows the first line.

#include <filesystem>
#include <functional>
#include <string>

#include "core/config/json.h"

namespace ulam {

/// Rises whenever what a state consists of, or its order, changes.
inline constexpr int kCheckpointFormat = 2;

/// Whether a render goes on from a checkpoint that is there.
enum class Resume {
    No,
    Yes,       ///< and refuses one that cannot be used
    IfUsable,  ///< or starts anew
};

/// Where a render keeps its state, and when.
struct CheckpointPlan {
    std::filesystem::path file;
    /// What the run is (scene, sampler, budget, random numbers, program). A checkpoint of another run is refused.
    Json identity;
    double interval = 30;  ///< seconds between checkpoints; more where writing one takes over a hundredth of it
    Resume resume = Resume::No;
    /// Told when a checkpoint could not be written; the render goes on, and the checkpoint before it stays.
    std::function<void(const std::string&)> warn = [](const std::string&) {};
};

/// Errors: CannotWrite.
void writeCheckpoint(const CheckpointPlan& plan, const std::string& state);

/// The state. Errors: InputMissing, and InvalidConfig where the file is damaged, of another format or of another run; the
/// message says what differs.
std::string readCheckpoint(const CheckpointPlan& plan);

/// Whether the file holds a checkpoint of this run.
bool isCheckpointOf(const CheckpointPlan& plan);

}  // namespace ulam
