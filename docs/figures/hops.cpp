// hops SPEC FORMAT[:OPTIONS] [FORMAT[:OPTIONS]…]: writes a BRDF in one format after the other,
// each from the file before, and prints the error of every hop and of all hops together:
// relative L2 error with the cosine, over all outgoing directions and at 45 degrees,
// as rows of the tables in docs/reference/conversion.md. The files go to the temporary folder and
// are removed.

#include <brdfs/catalog.h>
#include <brdfs/rows/spec.h>
#include <hshfit/accuracy/metrics.h>
#include <hshfit/error.h>

#include <fmt/core.h>

#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace {

using namespace hshfit;
namespace fs = std::filesystem;

/// Relative L2 error with the cosine over all outgoing directions, then at 45 degrees.
std::string errors(const Brdf& reference, const Brdf& brdf) {
    const OutgoingSet all =
        reference.laws().isotropic ? OutgoingSet::elevations(16) : OutgoingSet::parabolic(8, 8);
    std::string text;
    for (const OutgoingSet& outgoing : {all, OutgoingSet::direction(radians(45), 0)}) {
        const auto values = compare(reference, brdf, outgoing, selectMetrics("relative-l2-cosine"));
        const auto& value = values.front().value;
        text += value ? fmt::format(" {:.2e} |", *value) : std::string(" - |");
    }
    return text;
}

struct File {
    fs::path path;
    std::unique_ptr<Brdf> brdf;
};

File hop(const Brdf& brdf, std::string_view target, std::size_t number) {
    const std::size_t colon = std::min(target.find(':'), target.size());
    const auto writers = brdfs::writers();
    const auto writer = std::ranges::find(writers, target.substr(0, colon), &brdfs::Writer::name);
    if (writer == writers.end()) {
        throw UsageError(fmt::format("no format {} is written", target.substr(0, colon)));
    }
    File file;
    file.path = fs::temp_directory_path() /
                fmt::format("hshfit-hop-{}-{}{}", getpid(), number, std::string(writer->extension));
    const std::string_view options =
        colon < target.size() ? target.substr(colon + 1) : std::string_view();
    const auto alterations = writer->write(
        brdf, file.path, brdfs::parseParameters(writer->name, writer->parameters, options),
        {.force = true});
    for (const std::string& alteration : alterations) fmt::print(stderr, "  {}\n", alteration);
    file.brdf = brdfs::open(file.path.string());
    return file;
}

void run(const std::string& spec, const std::vector<std::string_view>& targets) {
    const auto source = brdfs::open(spec);
    std::vector<File> files;
    std::string route = fs::exists(spec) ? fs::path(spec).stem().string() : spec;
    for (const std::string_view target : targets) {
        const Brdf& before = files.empty() ? *source : *files.back().brdf;
        const auto start = std::chrono::steady_clock::now();
        files.push_back(hop(before, target, files.size()));
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        route += fmt::format(" -> {}", target);
        fmt::print("| {} |{}{} {:.1f} MB, {:.1f} s |\n", route, errors(before, *files.back().brdf),
                   errors(*source, *files.back().brdf),
                   static_cast<double>(fs::file_size(files.back().path)) / 1e6, seconds.count());
    }
    for (const File& file : files) fs::remove(file.path);
}

}  // namespace

int main(int count, char** arguments) {
    if (count < 3) {
        fmt::print(stderr, "usage: hops SPEC FORMAT[:OPTIONS]...\n");
        return 2;
    }
    try {
        run(arguments[1], {arguments + 2, arguments + count});
    } catch (const Error& error) {
        fmt::print(stderr, "hops: {}\n", error.what());
        return static_cast<int>(error.code());
    }
    return 0;
}
