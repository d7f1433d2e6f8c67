// ulam new mutation NAME: a file to start from.

#include <cctype>
#include <filesystem>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/config/suggest.h"
#include "core/mcmc/sample.h"
#include "experiments/cli/commands.h"

namespace ulam {
namespace {

constexpr const char* kTemplate =
    R"(// @name@: every primary number moves by a uniform step, wrapped around the unit interval.
//
// A mutation proposes, the kernel decides. This one works on primary numbers; one that works on paths returns
// Space::Path, fills y.path and y.factors (see core/mcmc/path_edit.h) and states both densities in the proposal.
// Try it:  ulam verify --mutation @name@

#include <cmath>
#include <limits>
#include <optional>

#include "core/mcmc/small_steps.h"

namespace ulam {
namespace {

class @Class@ : public Mutation {
public:
    struct Parameters {
        double width = 0.02;
        template <class V>
        void describe(V& v) {
            v("width", width, {.help = "largest step of a number", .min = 0, .max = 0.5, .minExclusive = true});
        }
    };
    explicit @Class@(const Parameters& p) : width_(p.width) {}

    Space space() const override { return Space::Primary; }

    /// q(x -> y) = q(y -> x), so logForward and logReverse stay 0.
    Proposal propose(const Sample& x, StepContext& context) const override {
        Proposal p;
        moveNumbers(x.u, p.y.u, context.random, [this](double u, Random& random) { return wrapped(u, width_ * (2 * random() - 1)); });
        return p;
    }

    /// The same density afresh, for the audit.
    std::optional<double> logDensity(const Sample& from, const Sample& to, StepContext&) const override {
        return logMoves(from.u, to.u, [this](double step) {
            return std::abs(step) <= width_ + 1e-12 ? -std::log(2 * width_) : -std::numeric_limits<double>::infinity();
        });
    }

private:
    double width_;
};

ULAM_REGISTER_MUTATION(@Class@, "@name@", "uniform steps of all primary numbers");

}  // namespace
}  // namespace ulam
)";

/// "my_step" → "MyStepMutation". The ending keeps it apart from the framework's names: a class Sample or Random would
/// hide the one that it needs.
std::string className(const std::string& name) {
    std::string out;
    bool upper = true;
    for (const char c : name) {
        if (c == '_')
            upper = true;
        else
            out += upper ? char(std::toupper(c)) : c, upper = false;
    }
    return out + "Mutation";
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    for (size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
        text.replace(at, from.size(), to);
    return text;
}

void newMutation(const std::string& name, const std::filesystem::path& folder) {
    constexpr std::string_view letters = "abcdefghijklmnopqrstuvwxyz0123456789_";
    const bool valid = !name.empty() && letters.substr(0, 26).find(name[0]) != letters.npos &&
                       name.find_first_not_of(letters) == std::string::npos;
    if (!valid)
        fail(ExitCode::Usage, "expected a name of lower-case letters, digits and _, such as my_step, found {}",
             inQuotes(name));
    for (const auto* entry : Registry<Mutation>::instance().entries())
        if (entry->name == name)
            fail(ExitCode::Usage, "mutation {} exists already, in {}", inQuotes(name), entry->file);
    const auto file = folder / (name + ".cpp");
    std::error_code ignored;  // what is wrong with the file's name is said by writing it
    if (!std::filesystem::is_directory(folder, ignored))
        fail(ExitCode::InputMissing, "no folder {}: start this in the project's folder, or give --folder",
             folder.string());
    if (std::filesystem::exists(file, ignored)) fail(ExitCode::Usage, "{} exists already", file.string());
    writeFileAtomically(file, replaced(replaced(kTemplate, "@name@", name), "@Class@", className(name)));
    fmt::print("{}\n", file.string());
}

}  // namespace

void addNewCommand(CLI::App& app) {
    auto* command = app.add_subcommand("new", "Start a new file");
    command->require_subcommand(1);
    auto* mutation =
        command->add_subcommand("mutation", "Write a mutation that compiles, is registered and passes the audit");
    auto name = std::make_shared<std::string>();
    auto folder = std::make_shared<std::string>("mutations");
    mutation->add_option("name", *name, "of the mutation and its file")->required();
    mutation->add_option("--folder", *folder, "where the file goes")->capture_default_str();
    mutation->callback([name, folder] { newMutation(*name, *folder); });
}

}  // namespace ulam
