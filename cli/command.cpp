#include "command.h"

#include "command_table.h"
#include "form_options.h"

#include <hshfit/brdf/colour.h>
#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/coefficient_files/representation_file.h>
#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/error.h>
#include <hshfit/gpu/containers/containers.h>
#include <hshfit/representation/forms/represented_brdf.h>

#include <brdfs/catalog.h>

#include <fmt/format.h>
#include <unistd.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <mutex>

namespace hshfit::cli {

void addCommand(CLI::App& app, Globals& globals, const Command& row) {
    CLI::App& command = *app.add_subcommand(row.name, row.help);
    command.group(row.group);
    command.footer(std::string("Example: ") + row.example);
    command.add_flag("--json", globals.json, "Print a machine-readable answer to standard output");
    command.add_flag("--quiet", globals.quiet, "No progress and no notes on standard error");
    command.add_option("--threads", globals.threads, "Threads to use; 0: all cores")
        ->check(CLI::Range(0, 4096));
    row.add(command, globals);
}

namespace {

std::unique_ptr<Brdf> seenAsRgb(std::unique_ptr<Brdf> brdf, bool rgb) {
    if (!rgb || brdf->channels().kind != Channels::Kind::spectral) return brdf;
    return asRgb(std::move(brdf));
}

}  // namespace

std::unique_ptr<Brdf> openBrdf(const std::string& spec, bool rgb) {
    return seenAsRgb(brdfs::open(spec), rgb);
}

std::unique_ptr<Brdf> openSource(const std::string& spec, bool rgb) {
    if (gpu::looksLikePayload(spec)) {
        auto coefficients = gpu::unpack(gpu::readPayload(spec).payload);
        return seenAsRgb(std::make_unique<Reconstruction>(std::move(coefficients)), rgb);
    }
    if (!looksLikeCoefficients(spec)) return openBrdf(spec, rgb);
    Representation representation = readRepresentation(spec);
    const bool plain = representation.steps.empty() && representation.added.empty() &&
                       representation.has("coefficients");
    if (plain) {
        return seenAsRgb(std::make_unique<Reconstruction>(decoded(representation)), rgb);
    }
    return seenAsRgb(reconstruct(std::move(representation), formOpener()), rgb);
}

void addRgb(CLI::App& command, bool& rgb) {
    command.add_flag("--rgb", rgb,
                     "Turn wavelengths into linear Rec. 709 (CIE 1931 2 degrees, D65)");
}

Direction parseDirection(const std::string& text, std::string_view option) {
    const char *at = text.data(), *end = at + text.size();
    double theta = 0, phi = 0;
    const auto first = std::from_chars(at, end, theta);
    const bool comma = first.ec == std::errc() && first.ptr != end && *first.ptr == ',';
    const auto second = comma ? std::from_chars(first.ptr + 1, end, phi) : first;
    if (!comma || second.ec != std::errc() || second.ptr != end || !(theta >= 0) ||
        !(theta <= 90) || !std::isfinite(phi)) {
        throw UsageError(
            fmt::format("{} '{}': give THETA,PHI in degrees, theta from 0 to 90 (for example 45,0)",
                        option, text));
    }
    return directionFromAngles(radians(theta), radians(phi));
}

OutgoingSet outgoingOrDefault(const std::string& text, const Brdf& brdf) {
    if (!text.empty()) return OutgoingSet::parse(text);
    return brdf.laws().isotropic ? OutgoingSet::elevations(16) : OutgoingSet::parabolic(16, 16);
}

void printText(std::string_view text) {
    const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
    if (!written || std::fflush(stdout) != 0) {
        throw OutputError(fmt::format("standard output: {}", std::strerror(errno)));
    }
}

void printJson(const nlohmann::ordered_json& document) {
    printText(document.dump(2) + "\n");
}

void note(const Globals& globals, std::string_view message) {
    if (!globals.quiet) fmt::print(stderr, "hshfit: {}\n", message);
}

struct Progress::State {
    using Clock = std::chrono::steady_clock;
    std::string what;
    std::mutex mutex;
    Clock::time_point start = Clock::now(), shown = start;
    bool visible = false;

    void update(std::size_t done, std::size_t total) {
        constexpr auto interval = std::chrono::milliseconds(200);
        const std::lock_guard lock(mutex);
        const auto now = Clock::now();
        if (now - shown < interval || done == 0) return;
        shown = now;
        visible = true;
        const double seconds = std::chrono::duration<double>(now - start).count();
        const double share = static_cast<double>(done) / static_cast<double>(total);
        fmt::print(stderr, "\r\x1b[K{}  {}/{}  {:.3g}/s  {:.0f} s left", what, done, total,
                   static_cast<double>(done) / seconds, seconds * (1 - share) / share);
        std::fflush(stderr);
    }
};

Progress::Progress(const Globals& globals, std::string what) {
    if (globals.quiet || !isatty(STDERR_FILENO)) return;
    state_ = std::make_shared<State>();
    state_->what = std::move(what);
}

Progress::~Progress() {
    if (state_ && state_->visible) fmt::print(stderr, "\r\x1b[K");
}

std::function<void(std::size_t, std::size_t)> Progress::callback() {
    if (!state_) return {};
    return [state = state_](std::size_t done, std::size_t total) { state->update(done, total); };
}

}  // namespace hshfit::cli
