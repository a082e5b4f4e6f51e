#pragma once

#include <hshfit/gpu/forms/form_payload.h>
#include <hshfit/gpu/shader_data.h>

#include <kainjow/mustache.hpp>

#include <optional>
#include <string>
#include <vector>

namespace hshfit::gpu::inline forms {

/// A product in a sum: a stored number for each channel, where there is one (an index into the
/// stream), times a function that the template names; empty: times 1.
struct SumTerm {
    std::string function;
    std::vector<std::optional<std::size_t>> numbers;  ///< [channel]
};
/// Terms in brackets times a common factor; empty: 1.
struct SumRun {
    std::string factor;
    std::size_t factorProducts = 0;  ///< multiplications that the factor takes
    std::vector<SumTerm> terms;
};

/// The page of a template that a row of the table fills in.
struct FormText {
    const FormPayload& payload;
    bool constants;  ///< numbers stand in the text
    kainjow::mustache::data& page;
    ShaderCost& cost;

    std::size_t channels() const { return payload.form.head.channels.count(); }

    /// The sums s0, s1, … of templates/sums.mustache: one three-vector for RGB, else a number
    /// per channel. Texels are loaded once, before the run that needs them first.
    void setSums(const std::vector<SumRun>& runs);
    /// The outputs f0, f1, …, each with the sum that it comes from.
    void setOutputs();
    /// A table of vectors from number `first` of the stream on, for lookups by computed places;
    /// the constants of the text where there are any. Gives the number of its first vector.
    std::size_t setTable(std::size_t first);
};

/// "x", "y", "z", "w".
std::string laneOf(std::size_t index);

}  // namespace hshfit::gpu::inline forms
