#include "fit_bands.h"

#include <jobs/common/pair_file.h>

#include <hshfit/error.h>

#include <brdfs/fit/band_rows.h>

#include <fmt/format.h>

#include <charconv>
#include <filesystem>

namespace hshfit::jobs {
namespace {

constexpr std::string_view plane = "plane:";

std::vector<double> anglesIn(std::string_view list, const std::string& text) {
    std::vector<double> angles;
    for (std::size_t first = 0; first <= list.size();) {
        const std::size_t last = std::min(list.find('/', first), list.size());
        const std::string_view cell = list.substr(first, last - first);
        double angle = 0;
        const auto read = std::from_chars(cell.data(), cell.data() + cell.size(), angle);
        if (cell.empty() || read.ec != std::errc() || read.ptr != cell.data() + cell.size() ||
            !(angle >= 0 && angle < 90))
            throw UsageError(
                fmt::format("{} '{}': '{}' is no polar angle; expected plane:T[/T...] with angles "
                            "of incidence from 0 to below 90 degrees, such as plane:30/60",
                            Setting{"FitOptions::bands"}, text, cell));
        angles.push_back(angle);
        first = last + 1;
    }
    return angles;
}

}  // namespace

std::vector<DirectionPair> bandPairs(const std::string& text) {
    std::vector<DirectionPair> pairs;
    if (text.starts_with(plane)) {
        constexpr int most = 89;
        for (const double angle : anglesIn(std::string_view(text).substr(plane.size()), text))
            for (int out = -most; out <= most; ++out)
                pairs.push_back({directionFromAngles(radians(angle), 0),
                                 directionFromAngles(radians(std::abs(out)), out > 0 ? pi : 0)});
        return pairs;
    }
    if (!std::filesystem::exists(text))
        throw InputError(
            fmt::format("{} '{}': no such file; expected a CSV of pairs or "
                        "plane:T[/T...], such as plane:30/60",
                        Setting{"FitOptions::bands"}, text));
    readPairs(text, [&](const PairRow& row) {
        if (!(row.wi.z > 0 && row.wo.z > 0))
            throw InputError(fmt::format(
                "{}: pair {} has a direction below the horizon, where a fit predicts nothing", text,
                pairs.size() + 1));
        pairs.push_back({row.wi, row.wo});
    });
    if (pairs.empty()) throw InputError(fmt::format("{}: has no pair of directions", text));
    return pairs;
}

std::unique_ptr<AtomicFile> addBands(const FitOptions& options, const Channels& channels,
                                     Fitted& fitted) {
    if (options.bands.empty()) return nullptr;
    const std::vector<DirectionPair> pairs = bandPairs(options.bands);
    const brdfs::Prediction prediction = brdfs::predict(fitted.result, pairs);
    constexpr double probability = 0.95;
    const brdfs::Bands bands{
        pairs, prediction,
        brdfs::simultaneousFactor(fitted.result, pairs, probability, options.seed)};
    fitted.preset["fit"]["bands"] = {{"pairs", options.bands},
                                     {"count", pairs.size()},
                                     {"pointwise_95", prediction.widest(probability)},
                                     {"simultaneous_95", bands.simultaneous},
                                     {"bootstrap_draws", fitted.result.point.draws.size()}};
    fitted.bands = brdfs::bandRowsJson(bands, channels);
    if (options.bandsTo.empty()) return nullptr;
    auto file = std::make_unique<AtomicFile>(options.bandsTo);
    brdfs::writeBandRows(bands, channels, [&](std::string_view row) { file->write(row); });
    file->finish();
    return file;
}

}  // namespace hshfit::jobs
