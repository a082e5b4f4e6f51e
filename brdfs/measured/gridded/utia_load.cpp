// The table of a UTIA file from its bytes.

#include <brdfs/measured/gridded/utia.h>
#include <hshfit/error.h>
#include <hshfit/files/exr_header.h>
#include <hshfit/files/exr_picture.h>
#include <hshfit/files/mapped_file.h>

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

namespace hshfit::brdfs {

static_assert(std::endian::native == std::endian::little, "UTIA files are little-endian");

namespace {

constexpr std::size_t plane = UtiaBrdf::nodes * UtiaBrdf::nodes;

std::vector<double> storedInPicture(std::string_view bytes, const std::string& file) {
    constexpr std::size_t side = UtiaBrdf::nodes, mostChannels = 16;
    const ExrPicture picture = readExrPicture(bytes, file, mostChannels * plane);
    if (picture.width != side || picture.height != side) {
        throw InputError(fmt::format("{}: is {} x {} pixels; a UTIA picture has {} x {}", file,
                                     picture.width, picture.height, side, side));
    }
    std::vector<double> stored(UtiaBrdf::values);
    constexpr std::string_view names[] = {"R", "G", "B"};
    for (std::size_t c = 0; c < 3; ++c) {
        const auto found = std::ranges::find(picture.channels, names[c]);
        if (found == picture.channels.end()) {
            throw InputError(fmt::format("{}: has no channel '{}'; a UTIA picture has R, G and B",
                                         file, names[c]));
        }
        const auto channel = static_cast<std::size_t>(found - picture.channels.begin());
        for (std::size_t row = 0; row < side; ++row) {
            for (std::size_t column = 0; column < side; ++column) {
                stored[c * plane + row * side + column] = picture.at(row, column, channel);
            }
        }
    }
    return stored;
}

std::vector<double> storedIn(std::span<const unsigned char> bytes, const std::string& file) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (hasExrMagic(text)) return storedInPicture(text, file);
    if (bytes.size() != UtiaBrdf::fileBytes) {
        throw InputError(
            fmt::format("{}: the file has {} bytes, expected {} for three planes of "
                        "288 x 288 float64",
                        file, bytes.size(), UtiaBrdf::fileBytes));
    }
    std::vector<double> stored(UtiaBrdf::values);
    std::memcpy(stored.data(), bytes.data(), bytes.size());
    return stored;
}

/// IEC 61966-2-1, continued linearly below 0.
double fromSrgb(double value) {
    return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

/// Rec. 709 primaries and D65 (IEC 61966-2-1, F.4).
std::array<double, 3> fromXyz(const std::array<double, 3>& v) {
    return {3.2406 * v[0] - 1.5372 * v[1] - 0.4986 * v[2],
            -0.9689 * v[0] + 1.8758 * v[1] + 0.0415 * v[2],
            0.0557 * v[0] - 0.2040 * v[1] + 1.0570 * v[2]};
}

}  // namespace

UtiaBrdf::UtiaBrdf(std::span<const unsigned char> bytes, std::string name,
                   const UtiaOptions& options)
    : name_(std::move(name)), options_(options) {
    std::vector<double> stored = storedIn(bytes, name_);
    picture_ = bytes.size() != fileBytes;
    takeStock(stored);
    if (firstBad_ >= 0) fillMissing(stored);
    decode(stored);
    table_.resize(plane);
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < plane; ++i) table_[i].rgb[c] = stored[c * plane + i];
    }
    averageAtNormal();
}

std::unique_ptr<UtiaBrdf> UtiaBrdf::open(const std::string& path, const UtiaOptions& options) {
    const MappedFile file(path);
    try {
        auto brdf = std::make_unique<UtiaBrdf>(file.bytes(), path, options);
        file.checkIntact();
        return brdf;
    } catch (const InputError&) {
        file.checkIntact();  // reports a file that was removed or cut while it was read
        throw;
    }
}

void UtiaBrdf::takeStock(const std::vector<double>& stored) {
    census_.values = stored.size();
    for (const double value : stored) census_.add(value * options_.scale);
    const auto bad = std::ranges::find_if_not(stored, [](double v) { return std::isfinite(v); });
    if (bad != stored.end()) firstBad_ = bad - stored.begin();
}

void UtiaBrdf::fillMissing(std::vector<double>& stored) const {
    for (std::size_t row = 0; row < stored.size(); row += phis) {
        const std::vector<double> before(stored.begin() + static_cast<std::ptrdiff_t>(row),
                                         stored.begin() + static_cast<std::ptrdiff_t>(row + phis));
        for (std::size_t p = 0; p < phis; ++p) {
            if (std::isfinite(before[p])) continue;
            std::size_t away = 1;
            while (away <= phis / 2 && !std::isfinite(before[(p + away) % phis]) &&
                   !std::isfinite(before[(p + phis - away) % phis])) {
                ++away;
            }
            const double ahead = before[(p + away) % phis];
            const double behind = before[(p + phis - away % phis) % phis];
            stored[row + p] = std::isfinite(ahead) ? ahead : std::isfinite(behind) ? behind : 0;
        }
    }
}

void UtiaBrdf::decode(std::vector<double>& stored) const {
    for (std::size_t i = 0; i < plane; ++i) {
        std::array<double, 3> v = {stored[i], stored[plane + i], stored[2 * plane + i]};
        if (options_.colours == UtiaOptions::Colours::srgb) {
            for (double& value : v) value = fromSrgb(value);
        } else if (options_.colours == UtiaOptions::Colours::xyz) {
            v = fromXyz(v);
        }
        for (std::size_t c = 0; c < 3; ++c) stored[c * plane + i] = options_.scale * v[c];
    }
}

/// The mean of the first 48 values of a row (of nodes) or column, at distance `step`, replaces each
/// of them. Returns the largest difference over the largest magnitude.
template <class Value>
double average(Value* first, std::size_t step, std::size_t count) {
    double spread = 0;
    for (int c = 0; c < 3; ++c) {
        double sum = 0, least = first->rgb[c], most = least, magnitude = 0;
        for (std::size_t p = 0; p < count; ++p) {
            const double value = first[p * step].rgb[c];
            sum += value / static_cast<double>(count);
            least = std::min(least, value);
            most = std::max(most, value);
            magnitude = std::max(magnitude, std::fabs(value));
        }
        if (magnitude > 0) spread = std::max(spread, (most - least) / magnitude);
        if (most == least) continue;  // the mean would be rounded
        for (std::size_t p = 0; p < count; ++p) first[p * step].rgb[c] = sum;
    }
    return spread;
}

void UtiaBrdf::averageAtNormal() {
    for (std::size_t n = 0; n < nodes; ++n) {
        poleSpread_ = std::max(poleSpread_, average(&table_[n], nodes, phis));  // wi at the normal
    }
    for (std::size_t n = 0; n < nodes; ++n) {
        poleSpread_ = std::max(poleSpread_, average(&table_[n * nodes], 1, phis));  // wo there
    }
}

/// The number of negative values after linear extrapolation to theta = 90 deg, for one of the
/// directions or both.
std::uint64_t UtiaBrdf::negativeBeyond() const {
    std::uint64_t negative = 0;
    const auto at = [this](std::size_t ti, std::size_t pi, std::size_t tv, std::size_t pv, int c) {
        return table_[(phis * ti + pi) * nodes + phis * tv + pv].rgb[c];
    };
    const auto alongView = [&](std::size_t ti, std::size_t pi, std::size_t tv, std::size_t pv,
                               int c) {
        return tv < thetas ? at(ti, pi, tv, pv, c)
                           : 2 * at(ti, pi, thetas - 1, pv, c) - at(ti, pi, thetas - 2, pv, c);
    };
    for (std::size_t ti = 0; ti <= thetas; ++ti) {
        for (std::size_t tv = ti < thetas ? thetas : 0; tv <= thetas; ++tv) {
            for (std::size_t p = 0; p < phis * phis * 3; ++p) {
                const int c = static_cast<int>(p % 3);
                const std::size_t pi = p / 3 / phis, pv = p / 3 % phis;
                const double f = ti < thetas ? alongView(ti, pi, tv, pv, c)
                                             : 2 * alongView(thetas - 1, pi, tv, pv, c) -
                                                   alongView(thetas - 2, pi, tv, pv, c);
                negative += f < 0;
            }
        }
    }
    return negative;
}

std::string UtiaBrdf::name() const {
    std::string options;
    const auto add = [&options](const std::string& option) {
        options += (options.empty() ? ":" : ",") + option;
    };
    if (options_.beyond == UtiaOptions::Beyond::constant) add("beyond=constant");
    if (options_.colours == UtiaOptions::Colours::srgb) add("colours=srgb");
    if (options_.colours == UtiaOptions::Colours::xyz) add("colours=xyz");
    if (options_.scale != 1) add(fmt::format("scale={}", options_.scale));
    return name_ + options;
}

std::vector<Fact> UtiaBrdf::facts() const {
    const bool linear = options_.beyond == UtiaOptions::Beyond::linear;
    constexpr std::size_t pairs = 2 * thetas + 1;  // of rings, one of them the horizon
    std::vector<Fact> facts = {
        {"format", "utia"},
        {"dimensions", "6 x 48 x 6 x 48"},
        {"stored_as", picture_ ? "OpenEXR, 288 x 288" : "float64 planes"},
        {"beyond_75_degrees", linear ? "linear, cut off at 0" : "constant"},
        {"largest_spread_at_normal", poleSpread_},
    };
    if (linear) {
        facts.emplace_back("values_continued_to_horizon",
                           static_cast<std::int64_t>(pairs * phis * phis * 3));
        facts.emplace_back("of_these_negative", static_cast<std::int64_t>(negativeBeyond()));
    }
    return facts;
}

void UtiaBrdf::checkIntact() const {
    if (firstBad_ < 0) return;
    const auto index = static_cast<std::size_t>(firstBad_);
    const std::size_t i = index % plane / nodes, v = index % nodes;
    const std::string where = picture_ ? "" : fmt::format(", offset {},", index * sizeof(double));
    throw InputError(fmt::format(
        "{}: the value of channel {} at theta_i {}, phi_i {}, theta_v {}, "
        "phi_v {}{} is not finite",
        name_, "RGB"[index / plane], 15 * (i / phis), 7.5 * static_cast<double>(i % phis),
        15 * (v / phis), 7.5 * static_cast<double>(v % phis), where));
}

}  // namespace hshfit::brdfs
