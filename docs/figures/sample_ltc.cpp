// sample_ltc lobe MODEL ROUGHNESS THETA: f cos(theta_i) and its transformed cosine in the plane of
// incidence, for wo at THETA degrees: signed angle of wi in degrees (the mirror direction is
// positive), truth, fit. For ltc.gp.
// sample_ltc published FOLDER: the table of GGX against the published one in FOLDER, at the cells
// and between them, for docs/explanation/ltc.md.

#include <brdfs/catalog.h>
#include <brdfs/fit/ltc_files.h>
#include <hshfit/error.h>

#include <brdfs/ltc_published.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string_view>

namespace {

using namespace hshfit;
using namespace hshfit::brdfs;

void printLobe(const std::string& model, double roughness, double theta) {
    const auto brdf = open(fmt::format("{}:alpha={}", model, roughness * roughness));
    // The elevations go in small steps from the normal, as in a table.
    Ltc ltc = firstLtc(*brdf, {0, 0, 1});
    LtcLobe lobe;
    Direction wo;
    constexpr int steps = 20;
    for (int k = 0; k <= steps; ++k) {
        wo = directionFromAngles(radians(theta) * k / steps, 0);
        lobe = fitLtc(*brdf, wo, ltc, {.symmetric = k == 0});
        ltc = turned(lobe.ltc, -radians(theta) / steps);
    }
    for (int k = -895; k <= 895; ++k) {
        const double angle = radians(k / 10.0);
        const Direction wi{-std::sin(angle), 0, std::cos(angle)};
        fmt::print("{:.1f} {:.6g} {:.6g}\n", k / 10.0, evaluate(*brdf, wi, wo)[0] * wi.z,
                   lobe.magnitude * lobe.ltc.density(wi));
    }
}

/// Mean errors of our lobes and of the published ones.
struct Sums {
    double ours = 0, theirs = 0, oursMisplaced = 0, theirsMisplaced = 0;
    int cells = 0, worse = 0;

    void add(const LtcLobe& our, const LtcLobe& their) {
        ours += our.error;
        theirs += their.error;
        oursMisplaced += our.misplaced;
        theirsMisplaced += their.misplaced;
        worse += our.error > 1.01 * their.error + 1e-6 ? 1 : 0;
        ++cells;
    }
    void print(const char* where) const {
        fmt::print(
            "{}: {} cells, cubed lobe error {:.4f} (published {:.4f}), misplaced {:.4f} "
            "({:.4f}), worse in {}\n",
            where, cells, ours / cells, theirs / cells, oursMisplaced / cells,
            theirsMisplaced / cells, worse);
    }
};

Ltc mean(const std::array<Ltc, 4>& m) {
    return {.a = (m[0].a + m[1].a + m[2].a + m[3].a) / 4,
            .c = (m[0].c + m[1].c + m[2].c + m[3].c) / 4,
            .b = (m[0].b + m[1].b + m[2].b + m[3].b) / 4,
            .d = (m[0].d + m[1].d + m[2].d + m[3].d) / 4};
}

void printPublished(const std::string& folder) {
    const test::PublishedLtc published(folder);
    if (!published.complete()) throw InputError(folder + ": has no published tables");
    constexpr int size = test::PublishedLtc::size;
    const LtcTable table = fitLtcTable("ggx", {.size = size});
    Sums at, between;
    double magnitude = 0, fresnel = 0, largest = 0;
    // Column 0 is left out: there alpha is 1e-4 for us and 1e-5 for them.
    for (int column = 1; column < size; ++column) {
        const auto brdf = open(fmt::format("ggx:alpha={}", table.values[column]));
        for (int row = 0; row < size; ++row) {
            const LtcLobe& lobe = table.cell(row, column);
            const double* energies = published.texel(1, row, column);
            magnitude += std::abs(lobe.magnitude - energies[0]);
            fresnel += std::abs(lobe.fresnel - energies[1]);
            largest = std::max(largest, std::abs(lobe.magnitude - energies[0]));
            const Direction wo = directionFromAngles(std::acos(table.cosines[row]), 0);
            LtcLobe best;
            best.error = HUGE_VAL;
            for (const Ltc& ltc : published.matrices(row, column)) {
                if (!(ltc.determinant() > 0)) continue;
                const LtcLobe judged = judgeLtc(*brdf, wo, ltc, lobe.ltc);
                if (judged.error < best.error) best = judged;
            }
            at.add(lobe, best);
        }
    }
    // Every fourth square, interpolated in its middle as in a shader.
    for (int column = 1; column + 1 < size; column += 2) {
        const double r = (column + 0.5) / (size - 1);
        const auto brdf = open(fmt::format("ggx:alpha={}", r * r));
        for (int row = 0; row + 1 < size; row += 2) {
            const double t = (row + 0.5) / (size - 1);
            std::array<Ltc, 4> ours, theirs;
            for (int k = 0; k < 4; ++k) {
                ours[k] = table.cell(row + k / 2, column + k % 2).ltc;
                theirs[k] = published.matrices(row + k / 2, column + k % 2)[0];
            }
            const Direction wo = directionFromAngles(std::acos(1 - t * t), 0);
            between.add(judgeLtc(*brdf, wo, mean(ours), mean(ours)),
                        judgeLtc(*brdf, wo, mean(theirs), mean(ours)));
        }
    }
    fmt::print("mean absolute difference: magnitude {:.5f} (largest {:.3f}), Fresnel part {:.5f}\n",
               magnitude / at.cells, largest, fresnel / at.cells);
    at.print("at the cells");
    between.print("between them");
}

}  // namespace

int main(int count, char** words) try {
    const std::string_view what = count > 1 ? words[1] : "";
    if (what == "lobe" && count == 5) {
        printLobe(words[2], std::strtod(words[3], nullptr), std::strtod(words[4], nullptr));
        return EXIT_SUCCESS;
    }
    if (what == "published" && count == 3) {
        printPublished(words[2]);
        return EXIT_SUCCESS;
    }
    throw UsageError("sample_ltc lobe MODEL ROUGHNESS THETA | published FOLDER");
} catch (const std::exception& error) {
    fmt::print(stderr, "sample_ltc: {}\n", error.what());
    return EXIT_FAILURE;
}
