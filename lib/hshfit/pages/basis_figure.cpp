#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/files/extension.h>
#include <hshfit/pages/basis_figure.h>
#include <hshfit/pages/gnuplot.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

namespace hshfit::embedded {
extern const std::string_view basis_gp;
}

namespace hshfit::inline pages {
namespace {

namespace fs = std::filesystem;

constexpr int highestOrder = 8, elevationSteps = 60, azimuthSteps = 90;
constexpr double largestRadius = 0.47;
/// Degrees about z, so that lobes along y can be seen.
constexpr double turned = -25;

struct Terminal {
    std::string_view extension, name;
};
constexpr Terminal terminals[] = {
    {".png", "pngcairo font 'sans,13' size"},
    {".svg", "svg font 'sans,13' size"},
    {".pdf", "pdfcairo font 'sans,13' size"},
};

const Terminal& terminalOf(const std::string& path) {
    const std::string extension = extensionOf(path);
    const auto* found = std::ranges::find(terminals, extension, &Terminal::extension);
    if (found == std::end(terminals)) {
        throw UsageError(
            fmt::format("{}: a figure of functions is written as .png, .svg or .pdf", path));
    }
    return *found;
}

/// Directions ring by ring from the pole, azimuthSteps + 1 a ring.
std::vector<Direction> grid(FigureDomain domain) {
    const double end = domain == FigureDomain::sphere ? 180 : 90;
    std::vector<Direction> directions;
    for (int i = 0; i <= elevationSteps; ++i) {
        // A pole slightly off the axis keeps its azimuth.
        const double theta = std::max(1e-6, radians(end * i / elevationSteps));
        for (int k = 0; k <= azimuthSteps; ++k) {
            directions.push_back(directionFromAngles(theta, radians(360.0 * k / azimuthSteps)));
        }
    }
    return directions;
}

/// One surface: columns x y z sign, a blank line after each ring, two after the surface.
std::string surface(const std::vector<Direction>& directions, const double* values, int l, int m) {
    double largest = 0;
    for (std::size_t k = 0; k < directions.size(); ++k) {
        largest = std::max(largest, std::abs(values[k]));
    }
    if (largest == 0) return {};
    std::string text;
    for (std::size_t k = 0; k < directions.size(); ++k) {
        const double radius = largestRadius * std::abs(values[k]) / largest;
        const Direction d = rotateAboutZ(directions[k], radians(turned));
        text += fmt::format("{:.5f} {:.5f} {:.5f} {}\n", m + radius * d.x, radius * d.y,
                            -l + radius * d.z, values[k] < 0 ? -1 : 1);
        if ((k + 1) % (azimuthSteps + 1) == 0) text += "\n";
    }
    return text + "\n";
}

std::string surfaces(const Basis& basis, FigureDomain domain) {
    const std::vector<Direction> directions = grid(domain);
    std::vector<double> x, y, z;
    for (const Direction& d : directions) {
        x.push_back(d.x);
        y.push_back(d.y);
        z.push_back(d.z);
    }
    std::vector<double> values(static_cast<std::size_t>(basis.slots()) * directions.size());
    basis.evaluateColumns({x.data(), y.data(), z.data(), x.size()}, values.data());
    std::string text;
    for (int l = 0; l < basis.order(); ++l) {
        for (int m = -l; m <= l; ++m) {
            if (!basis.has(l, m)) continue;
            const auto slot = static_cast<std::size_t>(bases::slotOf(l, m));
            text += surface(directions, &values[slot * directions.size()], l, m);
        }
    }
    return text;
}

/// Whether a basis is defined below the horizon.
bool definedOnSphere(std::string_view basis) {
    return basis == "sh" || basis == "esh";
}

}  // namespace

void writeBasisFigure(const Basis& basis, FigureDomain domain, const std::string& path) {
    const Terminal& terminal = terminalOf(path);
    if (basis.order() > highestOrder) {
        throw UsageError(fmt::format("order {} is too high for a figure; it has to be from 1 to {}",
                                     basis.order(), highestOrder));
    }
    if (domain == FigureDomain::sphere && !definedOnSphere(basis.name())) {
        throw UsageError(fmt::format(
            "{} is defined over the hemisphere only; sh and esh have values below the horizon",
            basis.name()));
    }
    AtomicFile data(path + ".data"), figure(path);
    data.write(surfaces(basis, domain));
    data.finish();
    AtomicFile script(path + ".gp");
    script.write(embedded::basis_gp);
    script.finish();
    const int last = basis.order() - 1, columns = std::max(2 * last + 2, 3);
    // Pixels, or inches for PDF, of a row and a column.
    const double unit = terminal.extension == ".pdf" ? 1.4 : 140;
    const std::string settings = fmt::format(
        "{}{}last={}; terminal={}; ", gnuplotFile("data", data), gnuplotFile("out", figure), last,
        gnuplotString(
            fmt::format("{} {:g},{:g}", terminal.name, unit * columns, unit * (last + 1.6))));
    const std::string folder = fs::absolute(path).parent_path().string();
    runGnuplot(folder, {"-e", settings, fs::absolute(script.temporaryPath()).string()},
               {fs::absolute(figure.temporaryPath()).string()});
    figure.commit();
}

}  // namespace hshfit::inline pages
