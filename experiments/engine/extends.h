#pragma once
// Experiments that share parts: "extends": "common.json".

#include "core/config/json.h"

namespace ulam {

/// An experiment's file together with the files that it extends, one or a list of them, which may extend others. Objects
/// are merged member by member, the later file counts and the experiment itself last; an object with another "type" than
/// before, a list and a single value replace what was there. The files stand in one folder, so that paths in them mean the
/// same. Messages name the file and line a value comes from. Fails with InvalidConfig, and with InputMissing.
JsonDocument readExperiment(const std::filesystem::path& file);

}  // namespace ulam
