// The bytes are a preset or a collection of them. A preset that parses is opened; f has to be
// finite and not negative, and the name to open the same again.

#include <brdfs/catalog.h>
#include <brdfs/catalog/preset.h>
#include <brdfs/presets/preset_collection.h>
#include <hshfit/error.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string_view>

namespace {

using namespace hshfit;
using namespace hshfit::brdfs;

void check(const Brdf& brdf) {
    const Direction directions[] = {{0, 0, 1}, {.6, 0, .8}, {-.6, 0, .8}, {0, 1, 1e-9}};
    for (const Direction& wi : directions)
        for (const Direction& wo : directions)
            for (const double f : evaluate(brdf, wi, wo))
                if (!(f >= 0) || !std::isfinite(f)) std::abort();
    if (open(brdf.name())->name() != brdf.name()) std::abort();
}

template <class Act>
void attempt(Act act) {
    try {
        act();
    } catch (const InputError& error) {
        if (std::strchr(error.what(), '\n')) std::abort();
    } catch (const UsageError& error) {
        if (std::strchr(error.what(), '\n')) std::abort();
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    if (!isPresetCollection(text)) {
        attempt([&] { check(*openPreset(text, "input")); });
        return 0;
    }
    attempt([&] {
        const PresetCollection collection = parsePresetCollection(text, "input");
        std::size_t most = 4;
        for (const auto& material : collection.materials) {
            attempt([&] { check(*openMaterial(text, "input", material.name)); });
            if (--most == 0) break;
        }
        openMaterial(text, "input", "blue-acrylik");
    });
    return 0;
}
