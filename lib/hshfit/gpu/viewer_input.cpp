#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/gpu/viewer.h>
#include <hshfit/projection/one_basis.h>

#include <fmt/format.h>

#include <algorithm>

namespace hshfit::gpu {
namespace {

/// Coefficients in SH, or in HSH if `payload` is in SH, at its order or the basis' highest.
Payload inOtherBasis(const Payload& payload, const Brdf& source,
                     std::function<void(std::size_t, std::size_t)> progress) {
    const char* name = payload.head.basis == "sh" ? "hsh" : "sh";
    const int order = std::min(payload.head.order, bases::find(name).maxOrder);
    const auto basis = bases::make(name, order, {.condonShortley = payload.head.condonShortley});
    const Projection projection =
        project(source, *basis, payload.head.outgoing,
                {.quantity = payload.head.quantity, .progress = std::move(progress)});
    return pack(projection.coefficients, {});
}

}  // namespace

ViewerInput viewerInput(Payload payload, const Brdf* source,
                        std::function<void(std::size_t, std::size_t)> progress) {
    ViewerInput input;
    input.title = payload.head.source.empty() ? "Coefficients" : shownName(payload.head.source);
    input.payloads.push_back(std::move(payload));
    if (!source) return input;
    try {
        input.payloads.push_back(inOtherBasis(input.payloads[0], *source, std::move(progress)));
    } catch (const NumericError&) {
        // The pane shows that there is only one basis.
    }
    input.reference = tabulate(*source);
    return input;
}

}  // namespace hshfit::gpu
