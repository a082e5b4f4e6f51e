// The parameters of one channel of a model as numbers N, and the weights of its terms. Compiled
// once for each instruction set.

#if defined(BRDFS_ANALYTIC_TERM_VALUES_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BRDFS_ANALYTIC_TERM_VALUES_H
#undef BRDFS_ANALYTIC_TERM_VALUES_H
#else
#define BRDFS_ANALYTIC_TERM_VALUES_H
#endif

#include <brdfs/analytic/model_columns.h>
#include <brdfs/analytic/term_batch.h>

#include <algorithm>
#include <array>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

template <class N>
struct SlopeCount {
    static constexpr int count = 0;
};
template <int n>
struct SlopeCount<Slopes<double, n>> {
    static constexpr int count = n;
};

template <class N>
class Values {
public:
    Values(const Parameters& parameters, std::size_t channel)
        : parameters_(parameters), channel_(channel) {}
    /// The linear parameter `unit` is 1 and all others are 0. Derivatives are by the shapes from
    /// `first` on.
    Values(const ColumnRequest& request, std::string_view unit, std::size_t first)
        : parameters_(request.values),
          channel_(request.channel),
          request_(&request),
          unit_(unit),
          first_(first) {}

    N operator()(std::string_view name) const {
        if (request_ && std::ranges::find(request_->linears, name) != request_->linears.end())
            return N(name == unit_ ? 1.0 : 0.0);
        const std::vector<double>& all = parameters_.numbers.find(name)->second;
        N value(all[all.size() == 1 ? 0 : channel_]);
        if constexpr (SlopeCount<N>::count > 0)
            for (std::size_t i = 0; i < std::size_t(SlopeCount<N>::count); ++i)
                if (first_ + i < request_->shapes.size() &&
                    std::ranges::find(request_->shapes[first_ + i], name) !=
                        request_->shapes[first_ + i].end())
                    value.by[i] = 1;
        return value;
    }
    std::size_t channel() const { return channel_; }
    /// The value in another channel, of which a fit has no derivatives.
    N of(std::string_view name, std::size_t channel) const {
        const std::vector<double>& all = parameters_.numbers.find(name)->second;
        return channel == channel_ || all.size() == 1 ? (*this)(name) : N(all[channel]);
    }
    /// Whether functions of this channel are wanted: of all, or in a fit of one.
    bool wanted(std::size_t channel) const { return !request_ || channel == channel_; }
    bool chosen(std::string_view name, std::string_view word) const {
        return parameters_.choice(name) == word;
    }
    bool given(std::string_view name) const { return parameters_.given(name); }

private:
    const Parameters& parameters_;
    std::size_t channel_ = 0;
    const ColumnRequest* request_ = nullptr;
    std::string_view unit_;
    std::size_t first_ = 0;
};

/// f = constant + sum_t term[t] T_t in one channel.
template <class N>
struct Weights {
    N constant = 0.0;
    std::array<N, TermBatch::maxTerms> term{};
    std::size_t count = 0;

    Weights(N c, std::initializer_list<N> terms) : constant(c), count(terms.size()) {
        std::ranges::copy(terms, term.begin());
    }
};

/// The weights of an evaluation, from the same formula: one for each channel.
template <class Formula>
TermWeights channelWeights(const Parameters& parameters) {
    std::size_t channels = 1;
    for (const auto& [name, values] : parameters.numbers)
        channels = std::max(channels, values.size());
    if constexpr (requires { Formula::coloured(parameters); })
        if (Formula::coloured(parameters)) channels = 3;
    TermWeights all;
    for (std::size_t c = 0; c < channels; ++c) {
        const Weights<double> own = Formula::weights(Values<double>(parameters, c));
        all.constant.push_back(own.constant);
        all.terms.resize(own.count);
        for (std::size_t t = 0; t < own.count; ++t) all.terms[t].push_back(own.term[t]);
    }
    return all;
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
