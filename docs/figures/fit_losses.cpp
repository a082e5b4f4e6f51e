// Errors of fits by their losses:
//     fit_losses CSV DATA… [--model MODEL] [--size PIXELS] [--light SPEC]… [--loss NAME]…
//                [--picture PNG] [--spheres PNG] [--metrics no]
//     fit_losses --of CSV…
// fits MODEL (lambert+ggx) to each DATA with every loss, at nodes or at the pixels of `picture`. It
// writes a row per DATA and loss to CSV: each loss' own metric as compare measures it, and of
// spheres under the lights of `picture` (or those given) mean FLIP and relative L2, with the
// largest FLIP of a pixel. For each loss, means over DATA, the worst of them, and the share of DATA
// on which it is the best go to stdout; --of prints this of the rows of several CSV. --loss leaves
// out other losses, --metrics no the metrics of compare. --spheres writes a row for each DATA: for
// each light the source and the fit by each loss, exposed for the source.

#include <brdfs/catalog.h>
#include <brdfs/fit/fit.h>
#include <brdfs/fit/picture_samples.h>
#include <hshfit/accuracy/metrics.h>
#include <hshfit/light/catalog.h>
#include <hshfit/pictures/flip.h>
#include <hshfit/pictures/sphere_picture.h>
#include <hshfit/rendering/lit_picture.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace {

using namespace hshfit;
using namespace hshfit::brdfs;

struct Arguments {
    std::string csv, picture, spheres, model = "lambert+ggx";
    std::vector<std::string> data, lights, losses;
    int size = 96;
    bool metrics = true;
};

Arguments argumentsOf(int argc, char** argv) {
    Arguments result;
    for (int k = 1; k < argc; ++k) {
        const std::string word = argv[k];
        if (word.starts_with("--") && k + 1 < argc) {
            const std::string value = argv[++k];
            if (word == "--model") result.model = value;
            if (word == "--metrics") result.metrics = value != "no";
            if (word == "--size") result.size = std::atoi(value.c_str());
            if (word == "--light") result.lights.push_back(value);
            if (word == "--loss") result.losses.push_back(value);
            if (word == "--picture") result.picture = value;
            if (word == "--spheres") result.spheres = value;
        } else if (result.csv.empty()) {
            result.csv = word;
        } else {
            result.data.push_back(word);
        }
    }
    if (result.lights.empty())
        for (const PictureLightRow& row : pictureLights()) result.lights.emplace_back(row.spec);
    return result;
}

RgbPicture shown(const SpherePicture& sphere, double stops) {
    RgbPicture result{sphere.size, sphere.size, sphere.radiance};
    for (std::size_t k = 0; k < result.values.size(); ++k)
        result.values[k] *= static_cast<float>(std::exp2(stops)) * sphere.coverage[k / 3];
    return result;
}

/// f with lobes that are stated no narrower than pictures of some tens of pixels show. Tables state
/// lobes as narrow as their finest cells, and a panel light would get 10^5 nodes at every pixel.
class SeenInPixels final : public Brdf {
public:
    explicit SeenInPixels(const Brdf& brdf) : brdf_(brdf) {}
    std::string name() const override { return brdf_.name(); }
    const Channels& channels() const override { return brdf_.channels(); }
    const Laws& laws() const override { return brdf_.laws(); }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override {
        brdf_.eval(wo, wi, out);
    }
    std::vector<Lobe> lobes(const Direction& wo) const override {
        std::vector<Lobe> lobes = brdf_.lobes(wo);
        for (Lobe& lobe : lobes) lobe.width = std::max(lobe.width, 0.01);
        return lobes;
    }

private:
    const Brdf& brdf_;
};

/// Pictures of a material under each light.
std::vector<SpherePicture> spheresOf(const Brdf& exact, const Arguments& arguments) {
    const SeenInPixels brdf(exact);
    const View view(radians(75), 0);
    const SurfacePoints points = spherePoints(view, arguments.size, 1);
    std::vector<SpherePicture> result;
    for (const std::string& text : arguments.lights) {
        const std::vector<Light> lights = parseLights(text).lights;
        const DirectIntegral integral(lights);
        result.push_back(renderByIntegration(brdf, points, view, integral,
                                             {.tolerance = 0.05, .maxEvaluations = 1 << 16})
                             .picture);
    }
    return result;
}

struct PictureErrors {
    double flip = 0, largest = 0, relativeL2 = 0;  ///< means over lights; the largest of all
};

PictureErrors errorsOf(const std::vector<SpherePicture>& reference,
                       const std::vector<SpherePicture>& own) {
    PictureErrors result;
    for (std::size_t l = 0; l < reference.size(); ++l) {
        const double stops = automaticExposure({&reference[l], 1});
        const std::vector<float> error = flip(shown(reference[l], stops), shown(own[l], stops));
        double sum = 0, area = 0;
        for (std::size_t k = 0; k < error.size(); ++k) {
            sum += static_cast<double>(error[k] * reference[l].coverage[k]);
            area += static_cast<double>(reference[l].coverage[k]);
            result.largest = std::max(result.largest, static_cast<double>(error[k]));
        }
        const double count = static_cast<double>(reference.size());
        result.flip += sum / area / count;
        result.relativeL2 += differenceOf(reference[l], own[l]).relativeL2 / count;
    }
    return result;
}

struct Row {
    std::string data, loss;
    FitResult fit = {};
    std::vector<MetricValue> metrics = {};
    PictureErrors errors = {};
};

std::vector<Row> rowsOf(const std::string& path, const Arguments& arguments,
                        std::vector<std::vector<SpherePicture>>& pictures) {
    const auto data = open(path);
    std::vector<std::string_view> names;
    for (const Loss& loss : losses())
        if (!loss.metric.empty()) names.push_back(loss.metric);
    const auto metrics = selectMetrics(fmt::format("{}", fmt::join(names, ",")));
    const OutgoingSet outgoing = comparedOutgoing(data->laws().isotropic);
    pictures.push_back(spheresOf(*data, arguments));
    const std::vector<SpherePicture> reference = pictures.back();
    const FitSamples nodes = gatherSamples(*data, {}), pixels = pictureSamples(*data);
    std::vector<Row> rows;
    const auto add = [&](const FitSamples& samples, Loss::Kind kind, std::string name) {
        Row row{.data = std::filesystem::path(path).filename().string(), .loss = std::move(name)};
        row.fit = fit(samples, {.model = arguments.model, .loss = kind});
        const auto fitted = openFit(row.fit);
        if (arguments.metrics) row.metrics = compare(*data, *fitted, outgoing, metrics);
        pictures.push_back(spheresOf(*fitted, arguments));
        row.errors = errorsOf(reference, pictures.back());
        fmt::print(stderr, "{} {}: FLIP {:.4f} L2 {:.4f} {} samples {}\n", row.data, row.loss,
                   row.errors.flip, row.errors.relativeL2, samples.size(), row.fit.spec);
        rows.push_back(std::move(row));
    };
    for (const Loss& loss : losses())
        if (arguments.losses.empty() || std::ranges::count(arguments.losses, loss.name) > 0)
            add(loss.kind == Loss::Kind::picture ? pixels : nodes, loss.kind,
                std::string(loss.name));
    return rows;
}

SpherePicture exposed(SpherePicture sphere, double stops) {
    for (float& value : sphere.radiance) value *= static_cast<float>(std::exp2(stops));
    return sphere;
}

/// `pictures` has, for each of DATA, pictures of the source and of the fit by each loss.
void writeCompared(const std::vector<std::vector<SpherePicture>>& pictures, std::size_t data,
                   const std::string& path) {
    const std::size_t each = pictures.size() / data;
    std::vector<std::vector<SpherePicture>> rows;
    for (std::size_t first = 0; first < pictures.size(); first += each) {
        rows.emplace_back();
        for (std::size_t l = 0; l < pictures[first].size(); ++l) {
            const double stops = automaticExposure({&pictures[first][l], 1});
            for (std::size_t k = first; k < first + each; ++k)
                rows.back().push_back(exposed(pictures[k][l], stops));
        }
    }
    AtomicFile out(path);
    writeSheet(Sheet(rows.begin(), rows.end()), 0, out);
    out.commit();
}

/// The errors of one fit.
struct Judged {
    std::string data, loss;
    PictureErrors errors = {};
};

/// The mean error of each loss, the largest and its data, and the number of data that it describes
/// best.
struct Summary {
    double mean = 0, worst = -1;
    std::string worstData;
    std::size_t best = 0;
};
std::map<std::string, Summary> summaries(const std::vector<Judged>& all,
                                         double PictureErrors::*error) {
    std::map<std::string, std::vector<const Judged*>> byData;
    std::map<std::string, Summary> result;
    for (const Judged& own : all) byData[own.data].push_back(&own);
    for (const Judged& own : all) {
        Summary& summary = result[own.loss];
        const double value = own.errors.*error;
        summary.mean += value / static_cast<double>(byData.size());
        if (!(value > summary.worst)) continue;
        summary.worst = value;
        summary.worstData = own.data;
    }
    for (const auto& [data, rivals] : byData) {
        const auto best = std::ranges::min_element(
            rivals, {}, [&](const Judged* own) { return own->errors.*error; });
        ++result[(*best)->loss].best;
    }
    return result;
}

void printSummaries(const std::vector<Judged>& all) {
    const auto flip = summaries(all, &PictureErrors::flip),
               l2 = summaries(all, &PictureErrors::relativeL2);
    std::size_t count = 0;
    double pixel = 0;
    for (const auto& [loss, own] : flip) count += own.best;
    fmt::print(
        "{} data\n| loss | mean FLIP | worst material | best of all | relative L2 | worst material "
        "| best of all | largest of a pixel |\n|---|---|---|---|---|---|---|---|\n",
        count);
    for (const auto& [loss, own] : flip) {
        const Summary& other = l2.at(loss);
        pixel = 0;
        for (const Judged& one : all)
            if (one.loss == loss) pixel = std::max(pixel, one.errors.largest);
        fmt::print("| `{}` | {:.3f} | {:.3f} {} | {} | {:.3f} | {:.3f} {} | {} | {:.3f} |\n", loss,
                   own.mean, own.worst, own.worstData, own.best, other.mean, other.worst,
                   other.worstData, other.best, pixel);
    }
}

/// The rows of a file that `run` wrote.
void readRows(const std::string& path, std::vector<Judged>& all) {
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
        line.resize(line.find(",\"") == line.npos ? line.size() : line.find(",\""));
        std::vector<std::string> cells;
        for (std::size_t first = 0; first <= line.size();) {
            const std::size_t last = std::min(line.find(',', first), line.size());
            cells.push_back(line.substr(first, last - first));
            first = last + 1;
        }
        if (cells.size() < 5) throw std::runtime_error(fmt::format("{}: '{}'", path, line));
        const std::size_t n = cells.size();
        all.push_back({cells[0],
                       cells[1],
                       {.flip = std::stod(cells[n - 3]),
                        .largest = std::stod(cells[n - 2]),
                        .relativeL2 = std::stod(cells[n - 1])}});
    }
}

void run(const Arguments& arguments) {
    std::ofstream file(arguments.csv);
    std::vector<Judged> judged;
    std::vector<std::vector<SpherePicture>> pictures;
    for (const std::string& path : arguments.data) {
        for (const Row& row : rowsOf(path, arguments, pictures)) {
            if (judged.empty()) {
                file << "data,loss";
                for (const MetricValue& value : row.metrics) file << "," << value.metric->name;
                file << ",flip,largest,l2,spec\n";
            }
            file << fmt::format("{},{}", row.data, row.loss);
            for (const MetricValue& value : row.metrics)
                file << (value.value ? fmt::format(",{:.7g}", *value.value) : ",");
            file << fmt::format(",{:.5f},{:.5f},{:.5f},\"{}\"\n", row.errors.flip,
                                row.errors.largest, row.errors.relativeL2, row.fit.spec);
            file.flush();
            judged.push_back({row.data, row.loss, row.errors});
        }
    }
    printSummaries(judged);
    if (!arguments.spheres.empty())
        writeCompared(pictures, arguments.data.size(), arguments.spheres);
    if (arguments.picture.empty()) return;
    Sheet sheet;
    for (const auto& row : pictures) sheet.emplace_back(row);
    AtomicFile out(arguments.picture);
    writeSheet(sheet, automaticExposure(pictures.front()), out);
    out.commit();
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc > 2 && std::string_view(argv[1]) == "--of") {
        std::vector<Judged> all;
        for (int k = 2; k < argc; ++k) readRows(argv[k], all);
        printSummaries(all);
        return 0;
    }
    const Arguments arguments = argumentsOf(argc, argv);
    if (arguments.data.empty()) return 2;
    run(arguments);
    return 0;
} catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
}
