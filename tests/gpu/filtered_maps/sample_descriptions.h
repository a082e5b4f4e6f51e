#pragma once

#include <hshfit/material_maps/exports/map_shader.h>

#include <cstddef>
#include <string>
#include <vector>

namespace hshfit::test {

/// A description for `svbrdf`, of normals that have nothing in common with their neighbours', so
/// that a wrong texel, level or share shows.
struct SampleDescription {
    std::string name, model;
    /// JSON; "@NAME:LOW:HIGH" stands for a map of noise in that range, of three channels if NAME
    /// begins with "rgb".
    std::string parameters;
    std::string form = "ellipse";
    int harmonics = 0;
    std::string precision = "float16";
    std::size_t width = 16, height = 8;
    bool direction = false, mips = true;
    bool turned = true;  ///< has a map of normals
    Wrap wrap = Wrap::clamp;
};
std::vector<SampleDescription> sampleDescriptions();

/// Writes the maps and the description to a folder that stands; its path.
std::string writeDescription(const SampleDescription& sample, const std::string& folder);

}  // namespace hshfit::test
