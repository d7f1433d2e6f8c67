#include "experiments/engine/tev.h"

#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <bit>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <limits>
#include <mutex>
#include <optional>
#include <span>
#include <system_error>
#include <thread>
#include <utility>

#include "core/base/error.h"
#include "core/config/suggest.h"

namespace ulam {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPatience{1000};  // with a viewer that takes nothing
constexpr std::chrono::seconds kFarewell{5};          // for the last image, with one that takes little
// Bytes of pixels. The length of a packet is a number of 32 bits, which tev has in an int on the way.
constexpr std::size_t kLargestImage = std::numeric_limits<std::int32_t>::max() - (1 << 20);

using Addresses = std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)>;

/// No addresses where the host is not known; `trouble` says why.
Addresses resolve(const std::string& address, std::string& trouble) {
    const std::size_t colon = address.rfind(':');
    std::string host = address.substr(0, colon);
    if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
    unsigned port = 0;
    const char* const end = address.data() + address.size();
    const bool number = colon != address.npos && std::from_chars(address.data() + colon + 1, end, port).ptr == end;
    if (host.empty() || !number || port == 0 || port > 65535)
        fail(ExitCode::Usage, "--tev: expected HOST:PORT, such as localhost:14158, found {}", inQuotes(address));
    addrinfo hints{}, *found = nullptr;
    hints.ai_socktype = SOCK_STREAM;
    if (const int error = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found))
        trouble = ::gai_strerror(error);
    return {found, ::freeaddrinfo};
}

[[noreturn]] void failWith(int error) {
    throw std::system_error(error, std::generic_category());
}

/// A connection on which nothing waits longer than kPatience. Functions throw std::system_error.
class Connection {
public:
    ~Connection() { close(); }

    /// From now on it gives up at this time, whatever happens; called by another thread.
    void endAt(Clock::time_point time) { end_ = time; }

    /// Viewers send nothing: what can be read is that they went away.
    bool isOpen() const {
        char byte;
        return socket_ >= 0 && ::recv(socket_, &byte, 1, MSG_PEEK | MSG_DONTWAIT) < 0 && errno == EAGAIN;
    }

    void open(const addrinfo* addresses) {
        for (const addrinfo* address = addresses;; address = address->ai_next) {
            try {
                return openOne(*address);
            } catch (const std::system_error&) {
                close();
                if (!address->ai_next) throw;
            }
        }
    }

    void send(std::span<const char> bytes) {
        while (!bytes.empty()) {
            const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
            if (sent >= 0)
                bytes = bytes.subspan(std::size_t(sent));
            else if (errno == EAGAIN)
                await();
            else if (errno != EINTR)
                failWith(errno);
            if (Clock::now() > end_.load()) failWith(ETIMEDOUT);
        }
    }

    void close() {
        if (socket_ >= 0) ::close(socket_);
        socket_ = -1;
    }

private:
    void openOne(const addrinfo& address) {
        socket_ = ::socket(address.ai_family, address.ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, address.ai_protocol);
        if (socket_ < 0) failWith(errno);
        if (::connect(socket_, address.ai_addr, address.ai_addrlen) == 0) return;
        if (errno != EINPROGRESS) failWith(errno);
        await();
        int error = 0;
        socklen_t size = sizeof error;
        ::getsockopt(socket_, SOL_SOCKET, SO_ERROR, &error, &size);
        if (error != 0) failWith(error);
    }

    void await() const {
        pollfd ready{socket_, POLLOUT, 0};
        if (::poll(&ready, 1, int(kPatience.count())) == 0) failWith(ETIMEDOUT);
    }

    int socket_ = -1;
    std::atomic<Clock::time_point> end_ = Clock::time_point::max();
};

enum class Operation : char { CreateImage = 4, UpdateImage = 6 };  // the third version of the latter

constexpr const char* kChannels[] = {"R", "G", "B"};
constexpr std::int32_t kChannelCount = std::size(kChannels);

/// Its length, the operation, and what belongs to it; pixels may follow. Numbers are little-endian.
class Packet {
public:
    Packet(Operation operation, bool grabsFocus, const std::string& name) {
        number(std::uint32_t{0});  // the length is known at the end
        bytes_ += char(operation);
        bytes_ += char(grabsFocus);
        text(name);
    }

    template <class Number>
    void number(Number value) {
        static_assert(std::endian::native == std::endian::little);
        bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    void channels() {
        number(kChannelCount);
        for (const char* channel : kChannels) text(channel);
    }

    const std::string& finish(std::size_t following = 0) {
        const auto length = static_cast<std::uint32_t>(bytes_.size() + following);
        std::memcpy(bytes_.data(), &length, sizeof length);
        return bytes_;
    }

private:
    void text(const std::string& value) { bytes_.append(value.c_str(), std::strlen(value.c_str()) + 1); }

    std::string bytes_;
};

void createImage(Connection& connection, const std::string& name, const Image& image) {
    Packet packet(Operation::CreateImage, true, name);
    packet.number(std::int32_t{image.width});
    packet.number(std::int32_t{image.height});
    packet.channels();
    connection.send(packet.finish());
}

/// All of its pixels.
void updateImage(Connection& connection, const std::string& name, const Image& image) {
    static_assert(sizeof(Rgb) == kChannelCount * sizeof(float));
    const std::span pixels(reinterpret_cast<const char*>(image.pixels.data()), image.pixels.size() * sizeof(Rgb));
    Packet packet(Operation::UpdateImage, false, name);
    packet.channels();
    for (const std::int32_t bound : {0, 0, image.width, image.height}) packet.number(bound);
    for (std::int64_t offset = 0; offset < kChannelCount; ++offset) packet.number(offset);
    for (int channel = 0; channel < kChannelCount; ++channel) packet.number(std::int64_t{kChannelCount});
    connection.send(packet.finish(pixels.size()));
    connection.send(pixels);
}

}  // namespace

class TevViewer::Sender {
public:
    Sender(const std::string& address, Progress& progress)
        : address_(address), progress_(progress), hosts_(resolve(address, trouble_)) {
        thread_ = std::thread([this] { work(); });
    }

    ~Sender() {
        connection_.endAt(Clock::now() + kFarewell);
        {
            const std::lock_guard lock(mutex_);
            ends_ = true;
        }
        changed_.notify_one();
        thread_.join();
        warnOnce();
    }

    void show(const std::string& name, Image image) {
        {
            const std::lock_guard lock(mutex_);
            waiting_ = {name, std::move(image)};
        }
        changed_.notify_one();
        warnOnce();
    }

private:
    struct Shown {
        std::string name;
        Image image;
    };

    void work() {
        while (const std::optional<Shown> shown = next()) {
            try {
                if (hosts_) send(*shown);
            } catch (const std::system_error& error) {
                connection_.close();
                const std::lock_guard lock(mutex_);
                trouble_ = error.code().message();
            }
        }
    }

    /// Waits for an image; none at the end.
    std::optional<Shown> next() {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return waiting_ || ends_; });
        return std::exchange(waiting_, std::nullopt);
    }

    void send(const Shown& shown) {
        const auto& [name, image] = shown;
        if (image.pixels.size() * sizeof(Rgb) > kLargestImage) failWith(EMSGSIZE);
        if (!connection_.isOpen()) {
            connection_.close();
            created_.clear();
            connection_.open(hosts_.get());
        }
        if (created_ != name) createImage(connection_, name, image);
        created_ = name;
        updateImage(connection_, name, image);
    }

    void warnOnce() {
        const std::lock_guard lock(mutex_);
        if (trouble_.empty() || warned_) return;
        warned_ = true;
        progress_.message(fmt::format("warning: no images for the viewer at {}: {}", address_, trouble_));
    }

    const std::string address_;
    Progress& progress_;

    std::mutex mutex_;
    std::condition_variable changed_;
    // Shared with the thread, under the mutex:
    std::optional<Shown> waiting_;
    bool ends_ = false;
    std::string trouble_;
    bool warned_ = false;

    // The thread's own:
    const Addresses hosts_;
    Connection connection_;
    std::string created_;  ///< the image that was last made in the viewer
    std::thread thread_;
};

TevViewer::TevViewer(const std::string& address, Progress& progress)
    : sender_(std::make_unique<Sender>(address, progress)) {}

TevViewer::~TevViewer() = default;

void TevViewer::show(const std::string& name, Image image) {
    sender_->show(name, std::move(image));
}

}  // namespace ulam
