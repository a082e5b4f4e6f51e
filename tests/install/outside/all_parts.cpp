// A function of every part, so that the libraries of all of them are linked; a square of two
// triangles is read.
#include <brdfs/catalog.h>
#include <brdfs/fit/fit.h>
#include <hshfit/gpu/vulkan/spirv.h>
#include <hshfit/hshfit.h>
#include <hshfit/light/catalog.h>
#include <hshfit/meshes/mesh_file.h>
#include <hshfit/plan/plan.h>
#include <hshfit/tradeoff/tradeoff.h>

#include <cstdio>

int main() try {
    // Addresses that the compiler cannot leave out.
    using Function = void (*)();
    const volatile Function linked[] = {
        reinterpret_cast<Function>(&hshfit::plan::planScene),
        reinterpret_cast<Function>(&hshfit::tradeoff::measure),
        reinterpret_cast<Function>(&hshfit::gpu::compileGlsl),
        reinterpret_cast<Function>(&hshfit::brdfs::fit),
    };
    static_cast<void>(linked[0]);
    const auto square =
        hshfit::meshFromBytes("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n", "square.obj");
    std::printf("%zu triangles\n", square.mesh.triangles.size());
    return square.mesh.triangles.size() == 2 ? 0 : 1;
} catch (const hshfit::Error& error) {
    std::fprintf(stderr, "all_parts: %s\n", error.what());
    return static_cast<int>(error.code());
}
