// The bytes are a library of materials.

#include <hshfit/error.h>
#include <hshfit/material_library/library_file.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace hshfit;
    using namespace hshfit::material_library;
    looksLikeLibrary({data, size < 64 ? size : 64});
    try {
        const Library library = parseLibrary(
            {data, size}, "input", [](const std::string& name) -> material_library::Basis {
                throw InputError(name + ": is another file");
            });
        for (const Material& material : library.materials) {
            const auto brdf = open(library, material, "input");
            for (const double f : evaluate(*brdf, {0.6, 0, 0.8}, {0, -1, 1e-12}))
                if (!(f >= 0) || !std::isfinite(f)) std::abort();
        }
    } catch (const InputError&) {
    }
    return 0;
}
