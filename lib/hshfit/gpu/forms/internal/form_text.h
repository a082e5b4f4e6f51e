#pragma once

#include <hshfit/gpu/forms/form_payload.h>
#include <hshfit/gpu/forms/form_shader.h>
#include <hshfit/gpu/shader_data.h>

#include <kainjow/mustache.hpp>

#include <functional>
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
    std::vector<SumTerm> terms;
    std::string name = {};  ///< of a scalar that the run begins; its terms have one number each
};
/// Runs in brackets times a common factor; empty: 1.
struct SumGroup {
    std::string factor;
    std::size_t factorProducts = 0;  ///< multiplications that the factor takes
    std::vector<SumRun> runs;
    char sum = 's';  ///< which of the sums of a form it adds to
};

/// The page of a template that a row of the table fills in.
struct FormText {
    const FormPayload& payload;
    bool constants;  ///< coefficients stand in the text
    kainjow::mustache::data& page;
    ShaderCost& cost;
    /// Constants in place of the values of the stream, where a form has better ones.
    std::vector<double> values = {};

    std::size_t channels() const { return payload.form.head.channels.count(); }
    /// Channels of a vector: 3 for RGB, else 1.
    std::size_t together() const;

    /// The sums s0, s1, … of templates/sums.mustache: one three-vector for RGB, else a number
    /// per channel; likewise for other letters that groups add to. Texels are loaded once, before
    /// the run that needs them first.
    void setSums(const std::vector<SumGroup>& groups);
    /// The outputs f0, f1, …, one for each sum.
    void setOutputs();
};

/// A function of a form and how it is filled in.
struct FormBody {
    std::string_view body;  ///< the template
    Storage storage;        ///< of the texels
    bool constants;         ///< numbers of sums stand in the text
    Channels channels;      ///< of the function's value
    std::function<void(FormText&)> fill;
};

/// The text of a shader; the keys `function` and `materials` of the page are "eval" and false
/// unless `fill` sets others.
std::string formText(Language language, const FormPayload& payload, const std::string& prefix,
                     const FormBody& body);

}  // namespace hshfit::gpu::inline forms
