#pragma once
// Who works at what. A process that renders a replicate holds a lease of its folder, so that processes and hosts that
// share a run do not do the same work. Leases save work; whether results are right does not depend on them.
//
// A lease is the file FOLDER/lease-N, made with O_EXCL, which says as JSON who holds it. Its holder touches it again
// and again; one that was not touched for the seconds it names has expired, and whoever makes lease-(N+1) has taken
// over: numbers only grow while a folder has a lease, so that of those who see the same expired lease one alone takes
// over. Ages are differences of times that the file system gave, so the clocks of hosts may differ.

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <utility>

namespace ulam {

/// Seconds after which a lease that is not renewed expires, where nothing else is asked for.
inline constexpr double kLeaseSeconds = 120;

struct LeaseHolder {
    int number = 0;    ///< of the lease: how many held it one after the other without one that released it
    std::string host;  ///< empty: who made it has not come to write its name
    pid_t process = 0;
    std::string since;     ///< UTC, by the holder's clock
    std::string job;       ///< of Slurm: "12_3"; empty: none
    double idle = 0;       ///< seconds since it was renewed
    bool expired = false;  ///< or its process is known to have ended
};

/// Who has the newest lease of a folder. None: there is no lease.
std::optional<LeaseHolder> leaseHolder(const std::filesystem::path& folder);

/// Removes a folder's leases that have expired, so that the next one has number 1 again.
void removeExpiredLeases(const std::filesystem::path& folder);

/// Whether a file of this name is a lease.
bool isLeaseFile(const std::string& name);

/// Renewed by a thread until it is released.
class Lease {
public:
    /// Nothing where another process has it, or claims it at the same time. The folder must be there. Fails with
    /// CannotWrite where the file cannot be made.
    static std::optional<Lease> claim(const std::filesystem::path& folder, double seconds = kLeaseSeconds);

    Lease(Lease&& other) noexcept
        : file_(std::exchange(other.file_, {})), number_(other.number_), renewal_(std::move(other.renewal_)) {}
    Lease& operator=(Lease&&) = delete;
    ~Lease();

    /// As LeaseHolder::number.
    int number() const { return number_; }

private:
    Lease(std::filesystem::path file, int number) : file_(std::move(file)), number_(number) {}

    std::filesystem::path file_;  ///< empty: moved from
    int number_;
    std::jthread renewal_;
};

}  // namespace ulam
