#pragma once

#include "filtered.h"
#include "svbrdf.h"

#include <jobs/common/option_row.h>

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace hshfit::jobs {

/// The options of maps of all forms.
struct MapOptions {
    std::string form = {};  ///< one of mapForms; empty: by the description
    std::string precision = "half";
    std::string halfway = "8,4,3";     ///< parseHalfway
    std::optional<double> error = {};  ///< none: the form's default
    int harmonics = 0;                 ///< FilteredMapOptions::harmonics
    std::size_t memory = 1024;         ///< MiB for bands, of each process
    SvbrdfOptions texels = {};         ///< the others of all forms
};

/// The rows; OptionRow::inputs are bits of mapFormBit.
OptionRows<MapOptions> mapOptions();

/// The form that is asked for, or else the one that suits the description. Throws InputError.
std::string mapFormOf(const std::string& description, const MapOptions& options);

/// One bit for each of mapForms.
unsigned mapFormBit(std::string_view form);
/// The forms of these bits as a message names them, "low-rank, clusters and halfway".
std::string mapFormNames(unsigned bits);

/// Makes a map in FOLDER, by `svbrdf` or `filteredMap`, and throws as they do.
std::variant<Svbrdf, FilteredMapAnswer> makeMap(const std::string& description,
                                                const std::string& folder,
                                                const MapOptions& options,
                                                const Listener& listener = {});

}  // namespace hshfit::jobs
