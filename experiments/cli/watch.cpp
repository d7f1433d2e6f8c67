// ulam watch: a page that follows a run, for browsers on this machine.

#include <fmt/format.h>
#include <httplib.h>
#include <sys/socket.h>
#include <unistd.h>

#include <thread>

#include "core/base/error.h"
#include "experiments/cli/arguments.h"
#include "experiments/cli/commands.h"
#include "experiments/engine/signals.h"
#include "experiments/report/live.h"
#include "experiments/report/page.h"

namespace ulam {
namespace {

using namespace std::chrono_literals;

constexpr const char* kHost = "127.0.0.1";
constexpr int kUsualPort = 8642;

/// A name that an outsider made point to this machine does not open the page (DNS rebinding). Ports may differ: tunnels
/// have their own.
bool isFromHere(const httplib::Request& request) {
    const std::string host = request.get_header_value("Host");
    const std::string name = host.substr(0, host.rfind(':'));
    return name == kHost || name == "localhost";
}

void answer(httplib::Server& server, const LiveReport& report) {
    server.set_pre_routing_handler([](const httplib::Request& request, httplib::Response& response) {
        response.set_header("Cache-Control", "no-store");
        if (isFromHere(request)) return httplib::Server::HandlerResponse::Unhandled;
        response.status = 403;
        return httplib::Server::HandlerResponse::Handled;
    });
    server.Get("/", [](const httplib::Request&, httplib::Response& response) {
        response.set_content(page::kWatch.data(), page::kWatch.size(), "text/html; charset=utf-8");
    });
    server.Get("/state", [&](const httplib::Request&, httplib::Response& response) {
        response.set_content(report.state().dump(), "application/json");
    });
    server.Get("/report", [&](const httplib::Request&, httplib::Response& response) {
        const auto text = report.page();
        if (!text) {
            response.status = 404;
            return;
        }
        const auto provide = [text](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
            return sink.write(text->data() + offset, length);
        };
        response.set_content_provider(text->size(), "text/html; charset=utf-8", provide);
    });
}

/// The port, `wanted` or, for 0, any that is free.
int listenAt(httplib::Server& server, int wanted) {
    // Not to share the port with another process, which the library would.
    server.set_socket_options([](socket_t socket) {
        const int yes = 1;
        ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    const int port = wanted == 0 ? server.bind_to_any_port(kHost) : server.bind_to_port(kHost, wanted) ? wanted : -1;
    if (port < 0) fail(ExitCode::Usage, "port {} is taken: give another --port, or 0 for any that is free", wanted);
    return port;
}

/// Serves in a thread, for as long as it lives.
class Listening {
public:
    explicit Listening(httplib::Server& server) : server_(server), thread_([&] { server.listen_after_bind(); }) {
        while (!server.is_running()) std::this_thread::yield();
    }
    ~Listening() {
        server_.stop();
        thread_.join();
    }

private:
    httplib::Server& server_;
    std::thread thread_;
};

void watch(const std::string& folder, int wanted) {
    const std::atomic<bool>& stopped = watchSignals();
    // A run on this machine comes first. Threads that are started from here on inherit it.
    [[maybe_unused]] const int niceness = ::nice(5);
    LiveReport report(folder);
    httplib::Server server;
    answer(server, report);
    const int port = listenAt(server, wanted);
    const Listening listening(server);
    fmt::print("http://{}:{}/\n", kHost, port);
    std::fflush(stdout);
    while (!stopped) {
        report.update();
        std::this_thread::sleep_for(100ms);
    }
    failIfSignalled("the run is not affected");
}

}  // namespace

void addWatchCommand(CLI::App& app) {
    auto folder = std::make_shared<std::string>();
    auto port = std::make_shared<int>(kUsualPort);
    CLI::App& command = *app.add_subcommand("watch", "serve a page, to this machine alone, that follows a run");
    command.add_option("run", *folder, "folder of the run, which need not be there yet")
        ->type_name("RUN_DIR")
        ->required();
    command.add_option("--port", *port, "of 127.0.0.1; 0: any that is free")
        ->check(CLI::Range(0, 65535))
        ->capture_default_str();
    addPluginOption(command);
    addResourceOption(command);
    command.callback([folder, port] { watch(*folder, *port); });
}

}  // namespace ulam
