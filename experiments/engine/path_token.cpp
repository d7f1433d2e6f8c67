#include "experiments/engine/path_token.h"

#include "core/base/error.h"
#include "experiments/engine/token.h"

namespace ulam {
namespace {

constexpr std::string_view kTokenPrefix = "path1-";

}  // namespace

std::string pathToken(const RunIdentity& run, const Json& repeat, const NonFiniteEvent& event) {
    return packToken(kTokenPrefix, {{"repeat", repeat},
                               {"scene_hash", run.sceneHash},
                               {"key", {run.key.low, run.key.high}},
                               {"kind", int(event.kind)},
                               {"unit", event.unit},
                               {"chain", event.chain},
                               {"step", event.step},
                               {"cause", event.cause}});
}

PathToken readPathToken(const std::string& token) {
    const JsonDocument document = unpackToken(kTokenPrefix, token);
    const JsonNode root = document.root();
    const auto key = root.at("key").elements();
    if (key.size() != 2) root.at("key").expected("two numbers");
    const int64_t kind = root.at("kind").integer();
    if (kind < 0 || kind > int(NonFiniteEvent::Kind::Step)) root.at("kind").expected("a number from 0 to 3");
    return {.repeat = root.at("repeat").json(),
            .sceneHash = root.at("scene_hash").string(),
            .key = {uint32_t(key[0].unsignedInteger()), uint32_t(key[1].unsignedInteger())},
            .event = {.kind = NonFiniteEvent::Kind(kind),
                      .unit = root.at("unit").unsignedInteger(),
                      .chain = uint32_t(root.at("chain").unsignedInteger()),
                      .step = root.at("step").unsignedInteger(),
                      .cause = root.at("cause").string()}};
}

}  // namespace ulam
