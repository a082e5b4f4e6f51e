// device_check FOLDER: runs the shaders that tests have kept in FOLDER (tests/gpu/device.sh) on
// Vulkan, OpenGL and OpenGL ES, on GPUs where there are any and else on renderers in software, and
// compares what they write with what the library computes. Then times those that are to be timed.
// Prints the devices, shaders that are out of their bounds, and two tables in Markdown. Exit code
// 1: a shader is out of its bound or does not run; 2: there is no device at all.

#include "../shaders/kept_shader.h"

#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <exception>
#include <functional>
#include <map>
#include <optional>

namespace hshfit::shaders {
namespace {

constexpr std::array apis{Api::vulkan, Api::openGl, Api::openGlEs};
using Choice = gpu::DeviceChoice::Kind;

/// Shaders of one kind on one interface.
struct Tally {
    int shaders = 0, failed = 0;
    double worst = 0;  ///< the largest difference over its bound
};

/// The device that one interface runs on.
struct Device {
    std::string name;
    bool software = false;
    std::function<std::vector<float>(const BoundShader&)> run;
};

struct Report {
    std::map<std::string, std::map<Api, Tally>> kinds;
    std::map<Api, std::string> devices;  ///< of those that are there
    int failed = 0;

    void check(const KeptShader& kept, const Device& device) {
        Tally& tally = kinds[kept.kind][kept.shader.api];
        ++tally.shaders;
        const double bound = device.software ? kept.bounds.software : kept.bounds.gpu;
        std::string problem;
        try {
            const double difference = largestDifference(kept.wanted, device.run(kept.shader));
            tally.worst = std::max(tally.worst, difference / bound);
            if (difference <= bound) return;
            problem = fmt::format("differs by {:.1e}, bound {:.1e}", difference, bound);
        } catch (const std::exception& error) {
            problem = error.what();
            problem = problem.substr(0, problem.find('\n'));
        }
        ++tally.failed;
        ++failed;
        fmt::print("FAILED: {}, {}, {}, {}: {}\n", kept.kind, kept.name, apiName(kept.shader.api),
                   kept.language, problem);
        std::fflush(stdout);
    }
};

std::string cell(const Tally& tally) {
    if (tally.shaders == 0) return "";
    return fmt::format("{} of {}, {:.2f}", tally.shaders - tally.failed, tally.shaders,
                       tally.worst);
}

void printChecks(const Report& report) {
    fmt::print(
        "\nShaders within their bounds, and the largest difference over its bound:\n\n"
        "| shaders |");
    for (const Api api : apis) fmt::print(" {} |", apiName(api));
    fmt::print("\n|---|---|---|---|\n");
    std::map<Api, Tally> all;
    for (const auto& [kind, of] : report.kinds) {
        fmt::print("| {} |", kind);
        for (const Api api : apis) {
            const auto found = of.find(api);
            const Tally tally = found == of.end() ? Tally{} : found->second;
            fmt::print(" {} |", report.devices.contains(api) ? cell(tally) : "not run");
            all[api].shaders += tally.shaders;
            all[api].failed += tally.failed;
            all[api].worst = std::max(all[api].worst, tally.worst);
        }
        fmt::print("\n");
    }
    fmt::print("| all |");
    for (const Api api : apis)
        fmt::print(" {} |", report.devices.contains(api) ? cell(all[api]) : "not run");
    fmt::print("\n");
}

/// A shader that is timed, with the evaluations of a pixel that one run makes.
struct Timed {
    std::string name;
    std::size_t pixels;
    gpu::ComputeProgram program;
    bool software;
    float repeats = 1;

    /// Seconds of an evaluation; for a renderer in software, processor seconds of all threads.
    double once() {
        const std::clock_t before = std::clock();
        double seconds = program.run(static_cast<std::uint32_t>(pixels / 64));
        if (software) seconds = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
        return seconds / static_cast<double>(pixels) / static_cast<double>(repeats);
    }
    /// Evaluations that take some hundredths of a second, or as many as keep directions apart.
    void choose() {
        constexpr double least = 0.02;
        constexpr float most = 4096;
        once();
        while (repeats < most &&
               once() * static_cast<double>(pixels) * static_cast<double>(repeats) < least) {
            repeats *= 4;
            program.write(3, {&repeats, 1});
        }
    }
};

/// The median of the seconds that a shader takes for an evaluation; all take turns.
std::vector<double> medians(std::vector<Timed>& all) {
    constexpr int turns = 5;
    std::vector<std::vector<double>> times(all.size());
    for (int k = 0; k < turns; ++k)
        for (std::size_t i = 0; i < all.size(); ++i) times[i].push_back(all[i].once());
    std::vector<double> result;
    for (std::vector<double>& of : times) {
        std::ranges::sort(of);
        result.push_back(of[of.size() / 2]);
    }
    return result;
}

/// Times of a million evaluations less the time of the first shader, and their ratios to the second
/// and to the third time.
void printTimes(const std::vector<KeptShader>& kept, const gpu::ComputeDevice& device) {
    std::vector<Timed> all;
    for (const KeptShader& one : kept) {
        const std::string& program = one.shader.program;
        const auto* words = reinterpret_cast<const std::uint32_t*>(program.data());
        all.push_back({.name = one.name.substr(3),
                       .pixels = one.shader.invocations,
                       .program = {device, {words, program.size() / 4}, one.shader.resources},
                       .software = device.software()});
        all.back().choose();
    }
    const std::vector<double> seconds = medians(all);
    fmt::print(
        "\n{} of a million evaluations, on {}:\n\n"
        "| shader | us | / {} | / {} |\n|---|---|---|---|\n",
        device.software() ? "Processor microseconds" : "Microseconds", device.name(), all[1].name,
        all[2].name);
    for (std::size_t i = 1; i < all.size(); ++i) {
        const double time = seconds[i] - seconds[0];
        fmt::print("| {} | {:.3g} | {:.2f} | {:.2f} |\n", all[i].name, 1e12 * time,
                   time / (seconds[1] - seconds[0]), time / (seconds[2] - seconds[0]));
    }
}

int run(const std::string& folder) {
    std::map<Api, std::vector<KeptShader>> kept;
    std::vector<KeptShader> timed;
    for (const std::string& path : keptShaders(folder)) {
        KeptShader one = readKeptShader(path);
        (one.kind == timedKind ? timed : kept[one.shader.api]).push_back(std::move(one));
    }
    Report report;
    const auto checkAll = [&](Api api, const Device& device) {
        report.devices[api] = device.name;
        fmt::print("{}: {}{}\n", apiName(api), device.name,
                   device.software ? " (in software)" : "");
        std::fflush(stdout);
        for (const KeptShader& one : kept[api]) report.check(one, device);
    };
    std::optional<gpu::ComputeDevice> vulkan;
    try {
        vulkan.emplace(gpu::DeviceChoice{.kind = Choice::any, .name = {}, .validate = true});
        checkAll(Api::vulkan, {vulkan->name(), vulkan->software(),
                               [&](const BoundShader& shader) { return runOn(*vulkan, shader); }});
    } catch (const NumericError& error) {
        fmt::print("no Vulkan device: {}\n", error.what());
    }
    for (const Api api : {Api::openGl, Api::openGlEs}) {
        try {
            const GlContext context(api, Choice::any);
            checkAll(api, {context.renderer(), context.software(),
                           [&](const BoundShader& shader) { return context.run(shader); }});
        } catch (const Missing& error) {
            fmt::print("no device of {}: {}\n", apiName(api), error.what());
        }
    }
    if (report.devices.empty()) return 2;
    for (const auto& [api, shaders] : kept)
        for (const KeptShader& one : shaders) report.kinds[one.kind].try_emplace(api);
    printChecks(report);
    if (vulkan && timed.size() > 3) printTimes(timed, *vulkan);
    if (!vulkan) fmt::print("\nFunctions are not timed without Vulkan.\n");
    return report.failed == 0 ? 0 : 1;
}

}  // namespace
}  // namespace hshfit::shaders

int main(int count, char** arguments) {
    try {
        if (count != 2) throw std::runtime_error("device_check FOLDER");
        return hshfit::shaders::run(arguments[1]);
    } catch (const std::exception& error) {
        fmt::print(stderr, "device_check: {}\n", error.what());
        return 1;
    }
}
