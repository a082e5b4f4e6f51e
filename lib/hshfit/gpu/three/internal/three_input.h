#pragma once

#include <hshfit/gpu/texels.h>
#include <hshfit/gpu/three/three_files.h>

#include <optional>
#include <string>
#include <vector>

namespace hshfit::gpu::inline three {

/// The same for both kinds of payload, as the templates need it.
struct ThreeInput {
    std::string title, generator, prefix;
    std::string form;    ///< in words, with its orders
    std::string number;  ///< of the stored numbers
    std::size_t bytes = 0;
    std::vector<std::string> channels;
    std::string glsl, wgsl;        ///< the snippets; WGSL takes texture and sampler as arguments
    bool cosine = false;           ///< eval has the cosine in it
    bool shade = false;            ///< there is shadeWorld
    bool oddSign = false;          ///< which takes functions of odd m with the Condon-Shortley sign
    std::optional<Texels> texels;  ///< float16, float32 or unorm8
    bool filtered = true;          ///< texels are interpolated
    std::vector<std::string> materials;  ///< of a library, by number
    std::optional<Texels> table;         ///< of the functions of a library, interpolated
};

/// The parts of a snippet of lookups for a node of three.js: the function, and the functions that
/// it calls. Table, cube, sampler, turn and number of levels are arguments.
struct LookUpNode {
    std::string main, functions;
};
LookUpNode lookUpNode(const std::string& wgsl, const std::string& prefix);

ThreeInput threeInput(const Payload& payload, const ThreeOptions& options);
ThreeInput threeInput(const FormPayload& payload, const ThreeOptions& options);
ThreeInput threeInput(const SharedSums& library, const std::vector<std::string>& names,
                      const ThreeOptions& options);

}  // namespace hshfit::gpu::inline three
