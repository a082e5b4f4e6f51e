#pragma once

#include <hshfit/gpu/payload.h>
#include <hshfit/gpu/shader.h>

#include <kainjow/mustache.hpp>

#include <cstddef>
#include <vector>

namespace hshfit::gpu {

/// A number as every shading language writes it: the nearest single-precision value.
std::string shaderNumber(double value);

/// A section of a template without rows yet.
kainjow::mustache::data list();

/// The cost of a function as emitted.
struct ShaderCost {
    std::size_t fetches = 0;   ///< of texels, filtered
    std::size_t products = 0;  ///< multiplications, each with its addition
};

constexpr const char* laneNames[] = {"x", "y", "z", "w"};

struct Band {
    int l, m;
};
Band bandOf(int slot);

/// Sets the words of a language (language_words.h), of a payload and of its light.
void setWords(Language language, const Payload& payload, const std::string& prefix,
              kainjow::mustache::data& data);
/// The map of outgoing directions: "parabolic" or "elevations" with their scales, or "single".
void setMap(const OutgoingSet& set, kainjow::mustache::data& data);
/// The templates that snippets share, as partials: turnBody, basisBody, lightBody, worldBody, ….
void setSharedPartials(kainjow::mustache::data& data);
/// A template with its data, without the gaps of sections that are left out.
std::string rendered(std::string_view text, const kainjow::mustache::data& data);

// The parts of a snippet that do not depend on the language, as the templates name them.

/// Constants of the basis: scale, powers, columns with their steps, functions.
void setBasis(const Payload& payload, const Basis& basis, kainjow::mustache::data& data,
              ShaderCost& cost);
/// Lookups, sums and outputs of `eval`.
void setEvaluation(const Payload& payload, kainjow::mustache::data& data, ShaderCost& cost);
/// Environment, weights, lookups, sums and outputs of `shade`. For grey and RGB payloads one pass
/// takes the three colours of the light; else there is a pass per channel, and the environment is
/// an array of structs or, if `flat`, of numbers, slot by slot. Returns the places in
/// Payload::slots of the functions that such light meets, ascending: the others have no weight.
std::vector<std::size_t> setShading(const Payload& payload, const Basis& basis,
                                    int environmentOrder, bool flat, kainjow::mustache::data& data,
                                    ShaderCost& cost);

/// Turns of `shadeWorld`: R_z(alpha) S R_z(-beta) S R_z(gamma) on the coefficients of the light, S
/// the exchange of y and z, a sparse matrix per band (rotation/sh_rotation.h), with sines and
/// cosines from the axes of the frame, accurate at the pole too.
void setFrameTurn(const Payload& payload, int environmentOrder, bool flat,
                  kainjow::mustache::data& data, ShaderCost& cost);

/// The same for light of R, G, B without the Condon-Shortley sign, with the template `worldBody`
/// of the statements that fill `env` from `light` in the frame t, b, n.
void setFrameTurn(int environmentOrder, kainjow::mustache::data& data);

/// A row of `Payload::toChannels`, without its zeros.
kainjow::mustache::data outputTerms(const std::vector<double>& factors, ShaderCost& cost);
/// Scale and offset of a layer's lanes, where numbers are normalised.
void setAffine(const Texels& texels, std::size_t layer, kainjow::mustache::data& row,
               ShaderCost& cost);

}  // namespace hshfit::gpu
