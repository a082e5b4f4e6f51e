#pragma once

#include <brdfs/fit/prediction.h>

#include <nlohmann/json_fwd.hpp>

#include <functional>
#include <span>
#include <string_view>

namespace hshfit::brdfs {

/// Bands of a fit at pairs of directions.
struct Bands {
    std::span<const DirectionPair> pairs;
    const Prediction& prediction;
    double simultaneous = 0;  ///< simultaneousFactor for 95 % over these pairs and all channels
};

/// As CSV, a row for each pair and channel:
///     pair, wi_x … wo_z, channel    number from 1 on; nm, R, G or B; empty for grey
///     f, standard_error             1/sr, Prediction
///     degrees_of_freedom            of the variance; empty: so many that they do not matter
///     low_68 … high_95              pointwise, by Student's distribution: f -+ 1 and 1.96 standard
///                                   errors for many degrees of freedom
///     all_low_95, all_high_95       simultaneous
///     bootstrap_error, bootstrap_low_68 … bootstrap_high_95    where the fit has draws
/// `write` gets the text line by line.
void writeBandRows(const Bands& bands, const Channels& channels,
                   const std::function<void(std::string_view)>& write);

/// The same rows as JSON: [{"pair": 1, "channel": "550", "f": …, "standard_error": …}, …].
nlohmann::ordered_json bandRowsJson(const Bands& bands, const Channels& channels);

/// The errors of a fit at its own samples: by which route, their root mean square, and the largest
/// in absolute size and relative to f, with the rows of the values.
nlohmann::ordered_json predictionJson(const FitSamples& samples, const FitResult& result,
                                      const Prediction& prediction);

}  // namespace hshfit::brdfs
