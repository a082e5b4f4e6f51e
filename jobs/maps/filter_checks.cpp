#include "filter_checks.h"

#include <hshfit/pictures/rgb_picture.h>

#include <algorithm>
#include <cmath>

namespace hshfit::jobs {
namespace {

constexpr int samples = 1024, pictureSamples = 64;
constexpr std::size_t pictureSide = 64, pixels = 256;
/// Texels travel between processes as they are.
constexpr std::size_t doublesOfTexel = sizeof(SurfaceTexel) / sizeof(double);
static_assert(sizeof(SurfaceTexel) % sizeof(double) == 0);

std::vector<MipPlace> measuredPlaces(const std::vector<LevelSize>& sizes, int texels) {
    std::vector<MipPlace> places;
    for (std::size_t level = 1; level < sizes.size() && texels > 0; ++level) {
        for (const std::size_t index :
             measuredTexels(sizes[level].width, sizes[level].height, {.texels = texels}))
            places.push_back({static_cast<int>(level), index});
    }
    return places;
}

std::size_t levelOfPicture(const std::vector<LevelSize>& sizes) {
    std::size_t level = std::min<std::size_t>(1, sizes.size() - 1);
    while (level + 1 < sizes.size() &&
           std::max(sizes[level].width, sizes[level].height) > pictureSide)
        ++level;
    return level;
}

std::vector<MipPlace> picturedPlaces(const std::vector<LevelSize>& sizes, int texels) {
    const std::size_t level = levelOfPicture(sizes);
    std::vector<MipPlace> places;
    if (level == 0 || texels == 0) return places;
    for (std::size_t k = 0; k < sizes[level].width * sizes[level].height; ++k)
        places.push_back({static_cast<int>(level), k});
    return places;
}

/// The numbers of stored texels; without harmonics where the map has none.
std::vector<double> storedAt(const FilteredMap& map, const MipPlace& place) {
    const auto level = static_cast<std::size_t>(place.level);
    const std::size_t width = map.sidecar().levels[level].width;
    return map.numbers(level, place.index % width, place.index / width);
}

MipErrorOptions optionsOf(const FilteredSidecar& sidecar) {
    MipErrorOptions options{.samples = samples};
    options.harmonics = sidecar.form == "harmonics";
    if (options.harmonics) options.orders = {sidecar.layout.order};
    return options;
}

const MipError& formIn(const MipErrors& errors, const std::string& form) {
    return *std::ranges::find(errors.forms, form, &MipError::form);
}

}  // namespace

FilterChecks::FilterChecks(std::size_t width, std::size_t height,
                           const std::vector<LevelSize>& sizes, int texels, Processes& processes)
    : width_(width),
      height_(height),
      processes_(processes),
      sizes_(sizes),
      ranges_(sizes.size()),
      pictureLevel_(levelOfPicture(sizes)),
      measured_(width, height, measuredPlaces(sizes, texels), samples),
      pictured_(width, height, picturedPlaces(sizes, texels), pictureSamples) {
    for (std::size_t k = 0; k < measured_.size(); ++k) {
        const MipPlace& place = measured_.place(k);
        Range& range = ranges_[static_cast<std::size_t>(place.level)];
        if (range.count++ == 0) range.first = k;
        byRow_[{place.level, place.index / sizes[static_cast<std::size_t>(place.level)].width}]
            .push_back(k);
    }
}

void FilterChecks::add(std::size_t y, std::span<const SurfaceTexel> row) {
    measured_.add(y, row);
    pictured_.add(y, row);
}

void FilterChecks::addFiltered(const MipRow& row, const MipLayout& layout) {
    const auto found = byRow_.find({row.level, row.y});
    if (found == byRow_.end()) return;
    for (const std::size_t k : found->second) {
        const std::size_t column = measured_.place(k).index % row.width;
        const auto numbers = row.texels.subspan(column * layout.size(), layout.size());
        measured_.texel(k).numbers.assign(numbers.begin(), numbers.end());
    }
}

/// Calls each(k) for the measured texels of a part's levels, in a fixed order.
template <class Each>
void FilterChecks::eachNumbers(const MipPart& part, const Each& each) const {
    for (int level = 1; level <= part.level; ++level) {
        const MipRows own = part.own(level);
        for (auto at = byRow_.lower_bound({level, own.first});
             at != byRow_.end() && at->first < std::pair(level, own.last); ++at)
            for (const std::size_t k : at->second) each(k);
    }
}

/// The texels of both sets, then the count and the numbers of each measured one.
std::vector<double> FilterChecks::taken(const MipPart& part) const {
    std::vector<double> all;
    for (const GatheredTexels* set : {&measured_, &pictured_}) {
        const std::vector<SurfaceTexel> texels = set->taken(part.own(0));
        const std::vector<double> numbers = bandValues<double>(std::as_bytes(std::span(texels)));
        all.insert(all.end(), numbers.begin(), numbers.end());
    }
    eachNumbers(part, [&](std::size_t k) {
        const std::vector<double>& numbers = measured_.texel(k).numbers;
        all.push_back(static_cast<double>(numbers.size()));
        all.insert(all.end(), numbers.begin(), numbers.end());
    });
    return all;
}

void FilterChecks::put(const MipPart& part, std::span<const double> numbers) {
    for (GatheredTexels* set : {&measured_, &pictured_}) {
        const std::size_t count = set->takenCount(part.own(0)) * doublesOfTexel;
        set->put(part.own(0), bandValues<SurfaceTexel>(std::as_bytes(numbers.first(count))));
        numbers = numbers.subspan(count);
    }
    eachNumbers(part, [&](std::size_t k) {
        const auto count = static_cast<std::size_t>(numbers.front());
        const auto own = numbers.subspan(1, count);
        measured_.texel(k).numbers.assign(own.begin(), own.end());
        numbers = numbers.subspan(1 + count);
    });
}

void FilterChecks::finish() {
    if (processes_.count() > 1) {
        const MipPart whole = MipParts(width_, height_).part(0);
        std::string text;
        if (processes_.isFirst()) {
            const std::vector<double> all = taken(whole);
            const auto bytes = std::as_bytes(std::span(all));
            text.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        }
        processes_.broadcast(text);
        if (!processes_.isFirst()) put(whole, bandValues<double>(std::as_bytes(std::span(text))));
    }
    measured_.finish();
    pictured_.finish();
}

MipErrorShare FilterChecks::shareOf(std::size_t texels) const {
    const ItemRange share = processes_.share(texels);
    return {share.first, share.last, [this, texels](std::vector<double>& records) {
                gatherValues(processes_, texels, records);
            }};
}

MipErrors FilterChecks::measureLevel(const FilteredSurface& surface, const MipLayout& layout,
                                     const LobeTable& table, const Range& range,
                                     const MipErrorOptions& options) const {
    return measureMipTexels(
        surface, layout, range.count,
        [&](std::size_t k, std::mt19937_64&) { return measured_.texel(range.first + k); }, table,
        options, shareOf(range.count));
}

MipErrors FilterChecks::worst(const FilteredSurface& surface, const MipLayout& layout,
                              const LobeTable& table, const std::vector<int>& orders,
                              std::vector<WorstOfForm>& places, const Listener& listener) const {
    MipErrors worst;
    MipErrorOptions options{.samples = samples, .orders = orders};
    options.harmonics = !orders.empty();
    const auto progress = listener.part("choosing the form");
    for (std::size_t level = 1; level < sizes_.size(); ++level) {
        const MipErrors own = measureLevel(surface, layout, table, ranges_[level], options);
        if (worst.forms.empty()) {
            worst = own;
            places.assign(own.forms.size(), {.level = level});
        }
        for (std::size_t k = 0; k < own.forms.size(); ++k) {
            WorstOfForm& place = places[k];
            const std::vector<double>& texels = own.forms[k].texels;
            for (std::size_t t = 0; t < texels.size(); ++t) {
                if (place.texelLevel > 0 && texels[t] <= place.texel) continue;
                const std::size_t index = measured_.place(ranges_[level].first + t).index;
                place.texel = texels[t];
                place.texelLevel = level;
                place.column = index % sizes_[level].width;
                place.row = index / sizes_[level].width;
            }
            if (own.forms[k].relative <= worst.forms[k].relative) continue;
            worst.forms[k] = own.forms[k];
            place.level = level;
        }
        if (progress) progress(level, sizes_.size() - 1);
    }
    return worst;
}

void FilterChecks::measure(const FilteredSurface& surface, const LobeTable& table,
                           const FilteredMap& map, std::vector<FilteredLevel>& levels,
                           const Listener& listener) {
    const FilteredSidecar& sidecar = map.sidecar();
    const auto progress = listener.part("measuring levels");
    for (std::size_t level = 1; level < sizes_.size(); ++level) {
        const Range& range = ranges_[level];
        for (std::size_t k = 0; k < range.count; ++k)
            measured_.texel(range.first + k).numbers =
                storedAt(map, measured_.place(range.first + k));
        const MipErrors errors =
            measureLevel(surface, sidecar.layout, table, range, optionsOf(sidecar));
        levels[level].texels = range.count;
        levels[level].noise = errors.noise;
        const auto filled = [&](const MipError& from) {
            FilteredError to{.relative = from.relative,
                             .largest = from.maximum,
                             .wi = from.wi,
                             .wo = from.wo,
                             .albedo = from.albedo,
                             .worstAlbedo = from.worstAlbedo};
            for (std::size_t k = 0; k < from.texels.size(); ++k) {
                to.mean += from.texels[k] / static_cast<double>(from.texels.size());
                if (k > 0 && from.texels[k] <= to.maximum) continue;
                to.maximum = from.texels[k];
                to.column = measured_.place(range.first + k).index % sizes_[level].width;
                to.row = measured_.place(range.first + k).index / sizes_[level].width;
            }
            return to;
        };
        levels[level].stored = filled(formIn(errors, sidecar.form));
        levels[level].parameters = filled(formIn(errors, "parameters"));
        if (progress) progress(level, sizes_.size() - 1);
    }
}

std::string FilterChecks::picture(const FilteredSurface& surface, const LobeTable& table,
                                  const FilteredMap& map) const {
    MipErrorOptions options = optionsOf(map.sidecar());
    options.outgoing = 6;
    options.incoming = 16;
    const MipErrors errors = measureMipTexels(
        surface, map.sidecar().layout, pictured_.size(),
        [&](std::size_t k, std::mt19937_64&) {
            MeasuredTexel texel = pictured_.texel(k);
            texel.numbers = storedAt(map, pictured_.place(k));
            return texel;
        },
        table, options, shareOf(pictured_.size()));
    const std::vector<double>& left = formIn(errors, map.sidecar().form).texels;
    const std::vector<double>& right = formIn(errors, "parameters").texels;
    const double largest =
        std::max(*std::ranges::max_element(left), *std::ranges::max_element(right));
    const auto [width, height] = sizes_[pictureLevel_];
    const std::size_t scale = std::max<std::size_t>(1, pixels / std::max(width, height));
    const std::size_t panel = width * scale, gap = 4;
    RgbPicture picture{static_cast<int>(2 * panel + gap), static_cast<int>(height * scale)};
    for (std::size_t y = 0; y < height * scale; ++y) {
        for (std::size_t x = 0; x < 2 * panel + gap; ++x) {
            float shade = 1;
            if (x < panel || x >= panel + gap) {
                const auto& side = x < panel ? left : right;
                const std::size_t column = (x < panel ? x : x - panel - gap) / scale;
                const double share = largest > 0 ? side[y / scale * width + column] / largest : 0;
                shade =
                    static_cast<float>(std::max(0.0, 1 + std::log10(std::max(share, 1e-3)) / 3));
            }
            picture.values.insert(picture.values.end(), 3, shade);
        }
    }
    return rgbPng(picture, 0);
}

}  // namespace hshfit::jobs
