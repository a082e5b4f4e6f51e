#pragma once

#include <jobs/common/listener.h>
#include "description.h"
#include "turn_maps.h"

#include <hshfit/material_maps/processes.h>
#include <hshfit/specification/parameters.h>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// A parameter that is not one number for all texels and channels.
struct VaryingParameter {
    const Parameter* row = nullptr;
    std::size_t channels = 1;  ///< 1, or 3 of a colour
    double low = 0, high = 0;  ///< that occur
};

/// The pictures of a description, opened and read once, by all processes together: all sizes agree,
/// every value is finite and one that the model takes.
class ParameterMaps {
public:
    /// Throws InputError that names the file, the texel and the valid values.
    ParameterMaps(const MaterialDescription& description, Processes& processes,
                  const Listener& listener);
    ~ParameterMaps();

    std::size_t width() const { return width_; }
    std::size_t height() const { return height_; }
    const std::vector<VaryingParameter>& varying() const { return varying_; }
    /// Values [parameter][channel] of a texel.
    std::size_t valuesOfTexel() const { return values_; }
    /// "model:key=value,…" of all that is the same for every texel and channel.
    const std::string& common() const { return common_; }

    /// A row: [parameter][channel][column]. By one thread at a time; best with rising rows.
    std::vector<float> row(std::size_t row);
    /// The frames of texels.
    TurnMaps& turns() { return *turns_; }
    /// Normals whose length is off by more than 5 %.
    std::size_t renormalised() const { return renormalised_; }
    void checkIntact() const;

private:
    class Map;
    void check(Processes& processes, const Listener& listener);

    std::size_t width_ = 0, height_ = 0, values_ = 0;
    std::vector<std::unique_ptr<Map>> maps_;  ///< of `varying_`; null where values are constant
    std::vector<VaryingParameter> varying_;
    std::vector<std::vector<double>> constants_;  ///< of `varying_`
    std::string common_;
    std::unique_ptr<TurnMaps> turns_;
    std::size_t renormalised_ = 0;
};

}  // namespace hshfit::jobs
