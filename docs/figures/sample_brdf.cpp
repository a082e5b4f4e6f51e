// sample_brdf albedo SPEC…: a table of directional albedos (channels averaged), for
// docs/reference/brdfs.md. sample_brdf lobe THETA SPEC: f in the plane of incidence for wo at THETA
// degrees in that plane, as columns x z of a lobe scaled to a largest radius of 1, for brdfs.gp.
// Signed angles: the mirror direction has the sign of +x.

#include <brdfs/catalog.h>
#include <hshfit/error.h>
#include <hshfit/projection/albedo.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <numeric>
#include <vector>

#include <fmt/format.h>

namespace {

using namespace hshfit;

constexpr double elevations[] = {0, 30, 60, 75, 85, 89};

double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

void printAlbedos(const Brdf& brdf, const char* spec) {
    fmt::print("| `{}` |", spec);
    for (const double theta : elevations) try {
            const Direction wo = directionFromAngles(radians(theta), 0);
            fmt::print(" {:.3f} |", mean(directionalAlbedo(brdf, wo)));
        } catch (const NumericError&) {
            fmt::print(" – |");
        }
    fmt::print("\n");
}

void printLobe(const Brdf& brdf, double theta) {
    const Direction wo = directionFromAngles(radians(theta), pi);
    constexpr int steps = 3600;
    std::vector<double> angles, values;
    for (int k = 0; k <= steps; ++k) {
        angles.push_back(radians(-89.5 + 179.0 * k / steps));
        const Direction wi{std::sin(angles.back()), 0, std::cos(angles.back())};
        values.push_back(mean(evaluate(brdf, wi, wo)));
    }
    const double largest = *std::ranges::max_element(values);
    for (std::size_t k = 0; k < values.size(); ++k)
        fmt::print("{:.5f} {:.5f}\n", values[k] / largest * std::sin(angles[k]),
                   values[k] / largest * std::cos(angles[k]));
}

}  // namespace

int main(int count, char** words) try {
    const std::string_view what = count > 1 ? words[1] : "";
    if (what == "albedo") {
        for (int k = 2; k < count; ++k) printAlbedos(*brdfs::open(words[k]), words[k]);
        return EXIT_SUCCESS;
    }
    if (what == "lobe" && count == 4) {
        printLobe(*brdfs::open(words[3]), std::strtod(words[2], nullptr));
        return EXIT_SUCCESS;
    }
    throw UsageError("sample_brdf albedo SPEC... | lobe THETA SPEC");
} catch (const std::exception& error) {
    fmt::print(stderr, "sample_brdf: {}\n", error.what());
    return EXIT_FAILURE;
}
