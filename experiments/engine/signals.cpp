#include "experiments/engine/signals.h"

#include <csignal>

#include "core/base/error.h"

namespace ulam {
namespace {

std::atomic<bool> stop = false;
std::atomic<int> caught = 0;

void onSignal(int number) {
    caught = number;
    stop = true;
    std::signal(number, SIG_DFL);
}

}  // namespace

const std::atomic<bool>& watchSignals() {
    std::signal(SIGINT, onSignal);
    std::signal(SIGTERM, onSignal);
    return stop;
}

void failIfSignalled(const std::string& message) {
    if (!stop) return;
    const bool interrupted = caught == SIGINT;
    fail(interrupted ? ExitCode::Interrupted : ExitCode::Terminated, "stopped by {}; {}",
         interrupted ? "SIGINT" : "SIGTERM", message);
}

}  // namespace ulam
