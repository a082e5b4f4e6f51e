#include <hshfit/tradeoff/wavelet_forms.h>

#include <hshfit/error.h>
#include <hshfit/wavelets/slices.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace hshfit::tradeoff {

using wavelets::TermsBrdf;
using wavelets::ValueBytes;

std::string MeasuredWavelets::name() const {
    return fmt::format("{}, best {} terms, {}, outgoing {}", wavelets::sohoName, terms,
                       valueBytes == 2 ? "half" : "float32", outgoing);
}

std::vector<MeasuredWavelets> measureWavelets(const Brdf& brdf, const PairReference& reference,
                                              const Sweep& sweep, std::size_t maxBytes) {
    const int most = *std::max_element(sweep.orders.begin(), sweep.orders.end());
    std::vector<MeasuredWavelets> forms;
    for (const std::string& set : outgoingSets(sweep, brdf)) {
        std::shared_ptr<const TermsBrdf::Source> source;
        try {
            source = TermsBrdf::project(brdf, OutgoingSet::parse(set), sweep.quantity,
                                        static_cast<std::size_t>(most) * most);
        } catch (const NumericError&) {
            return {};
        }
        const std::size_t first = forms.size();
        std::vector<TermsBrdf> made;
        for (const int order : sweep.orders) {
            for (const ValueBytes width : {ValueBytes::single, ValueBytes::half}) {
                const std::size_t terms = static_cast<std::size_t>(order) * order;
                TermsBrdf form(source, terms, width);
                if (form.bytes() > maxBytes) continue;
                forms.push_back({.outgoing = set,
                                 .terms = terms,
                                 .valueBytes = static_cast<std::size_t>(width),
                                 .bytes = form.bytes(),
                                 .errors = {},
                                 .bands = {}});
                made.push_back(std::move(form));
            }
        }
        tbb::parallel_for(std::size_t{0}, made.size(), [&](std::size_t k) {
            auto errors = reference.errorsOf(made[k]);
            forms[first + k].errors = std::move(errors.all);
            forms[first + k].bands = std::move(errors.bands);
        });
    }
    return forms;
}

}  // namespace hshfit::tradeoff
