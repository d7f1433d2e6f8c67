#include "experiments/engine/lease.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <mutex>
#include <system_error>
#include <vector>

#include "core/base/file.h"
#include "core/config/json.h"
#include "experiments/engine/provenance.h"

namespace ulam {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kLeasePrefix = "lease-";
constexpr int kRenewalsPerLease = 4;

fs::path leaseFile(const fs::path& folder, int number) {
    return folder / fmt::format("{}{}", kLeasePrefix, number);
}

/// The number in the name of a lease; 0 for other names.
int numberOf(const std::string& name) {
    int number = 0;
    if (!name.starts_with(kLeasePrefix)) return 0;
    const char* const end = name.data() + name.size();
    const auto [stop, error] = std::from_chars(name.data() + kLeasePrefix.size(), end, number);
    return error == std::errc() && stop == end && number > 0 ? number : 0;
}

/// Of the leases in a folder, the newest first. A folder that cannot be listed seems to have none: making one tells.
std::vector<int> leaseNumbers(const fs::path& folder) {
    std::vector<int> numbers;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error); !error && entry != fs::directory_iterator();
         entry.increment(error))
        if (const int number = numberOf(entry->path().filename().string())) numbers.push_back(number);
    std::ranges::sort(numbers, std::greater());
    return numbers;
}

/// Makes a file that is not there yet. False where it is: of several processes and hosts that try, one makes it. Fails
/// with CannotWrite, leaving no file.
bool makeFile(const fs::path& file, std::string_view text) {
    const int descriptor = openFile(file, O_WRONLY | O_CREAT | O_EXCL);
    if (descriptor < 0 && errno == EEXIST) return false;
    int error = descriptor < 0 ? errno : 0;
    while (!error && !text.empty()) {
        const ssize_t written = ::write(descriptor, text.data(), text.size());
        if (written < 0 && errno != EINTR) error = errno;
        if (written > 0) text.remove_prefix(std::size_t(written));
    }
    if (descriptor >= 0 && ::close(descriptor) != 0 && !error && errno != EINTR) error = errno;
    if (!error) return true;
    if (descriptor >= 0) ::unlink(file.c_str());
    fail(ExitCode::CannotWrite, "cannot write {}: {}", file.string(), std::generic_category().message(error));
}

/// Seconds since the epoch; none where there is no such file.
std::optional<double> timeOfChange(const fs::path& file) {
    struct stat status {};
    if (::stat(file.c_str(), &status) != 0) return {};
    return double(status.st_mtim.tv_sec) + 1e-9 * double(status.st_mtim.tv_nsec);
}

/// The file system's clock, told by a file that is touched now; this host's where none can be.
double now(const fs::path& folder) {
    const fs::path touched = folder / temporaryName();
    std::optional<double> time;
    try {
        makeFile(touched, "");
        time = timeOfChange(touched);
        ::unlink(touched.c_str());
    } catch (const Error&) {  // somebody who may only look
    }
    return time.value_or(double(::time(nullptr)));
}

bool hasEnded(pid_t process) {
    return process > 0 && ::kill(process, 0) != 0 && errno == ESRCH;
}

/// None where it is gone.
std::optional<LeaseHolder> holderOf(const fs::path& folder, int number) {
    const fs::path file = leaseFile(folder, number);
    LeaseHolder holder;
    holder.number = number;
    double seconds = kLeaseSeconds;
    try {
        // Reading comes first: a network file system looks at a file anew when it is opened.
        const Json json = Json::parse(readFile(file), nullptr, false);
        if (json.is_object()) {
            holder.host = json.value("host", "");
            holder.process = json.value("process", 0);
            holder.since = json.value("since", "");
            holder.job = json.value("job", "");
            seconds = json.value("seconds", kLeaseSeconds);
        }
    } catch (const Error&) {
    } catch (const Json::exception&) {  // of a type it should not have: somebody unknown
    }
    const auto renewed = timeOfChange(file);
    if (!renewed) return {};
    holder.idle = std::max(0.0, now(folder) - *renewed);
    holder.expired = holder.idle > seconds || (holder.host == hostName() && hasEnded(holder.process));
    return holder;
}

/// "12_3" in a task of a Slurm job array, "12" in another job.
std::string slurmJob() {
    const auto variable = [](const char* name) {
        const char* value = std::getenv(name);
        return std::string(value ? value : "");
    };
    const std::string array = variable("SLURM_ARRAY_JOB_ID");
    return array.empty() ? variable("SLURM_JOB_ID") : array + "_" + variable("SLURM_ARRAY_TASK_ID");
}

void renewAgainAndAgain(const std::stop_token& stop, const fs::path& file, double seconds) {
    std::mutex mutex;
    std::condition_variable_any never;
    std::unique_lock lock(mutex);
    while (!never.wait_for(lock, stop, std::chrono::duration<double>(seconds / kRenewalsPerLease),
                           [&] { return stop.stop_requested(); }))
        ::utimensat(AT_FDCWD, file.c_str(), nullptr, 0);  // who has lost it may go on all the same
}

}  // namespace

bool isLeaseFile(const std::string& name) {
    return numberOf(name) > 0;
}

std::optional<LeaseHolder> leaseHolder(const fs::path& folder) {
    for (const int number : leaseNumbers(folder))
        if (const auto holder = holderOf(folder, number)) return holder;
    return {};
}

void removeExpiredLeases(const fs::path& folder) {
    for (const int number : leaseNumbers(folder)) {
        const auto holder = holderOf(folder, number);
        if (holder && holder->expired) ::unlink(leaseFile(folder, number).c_str());
    }
}

std::optional<Lease> Lease::claim(const fs::path& folder, double seconds) {
    const auto before = leaseHolder(folder);
    if (before && !before->expired) return {};
    const int number = before ? before->number + 1 : 1;
    Json holder = {{"host", hostName()}, {"process", ::getpid()}, {"since", utcNow()}, {"seconds", seconds}};
    if (const std::string job = slurmJob(); !job.empty()) holder["job"] = job;
    const fs::path file = leaseFile(folder, number);
    if (!makeFile(file, holder.dump() + "\n")) return {};
    Lease lease(file, number);
    // What was seen before may have changed until the file was made: then another lease is there now that is newer or
    // has not expired. Of two who make theirs at once, the later one sees both.
    std::vector<int> older;
    for (const int other : leaseNumbers(folder)) {
        if (other == number) continue;
        const auto holds = holderOf(folder, other);
        if (holds && (other > number || !holds->expired)) return {};
        older.push_back(other);
    }
    for (const int other : older) ::unlink(leaseFile(folder, other).c_str());
    lease.renewal_ =
        std::jthread([file, seconds](const std::stop_token& stop) { renewAgainAndAgain(stop, file, seconds); });
    return lease;
}

Lease::~Lease() {
    if (file_.empty()) return;
    if (renewal_.joinable()) {
        renewal_.request_stop();
        renewal_.join();
    }
    ::unlink(file_.c_str());
}

}  // namespace ulam
