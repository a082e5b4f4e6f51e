#include <hshfit/error.h>
#include <hshfit/light/internal/image_module.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <dlfcn.h>

#include <filesystem>

namespace hshfit::inline light {
namespace {

/// Beside the program, in the library folder of an installation, and where it was built.
std::vector<std::string> places() {
    const std::string name = "libhshfit_openimageio.so";
    std::vector<std::string> paths;
    std::error_code error;
    const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
    if (!error) {
        const auto folder = program.parent_path();
        paths.push_back((folder / name).string());
        paths.push_back((folder.parent_path() / "lib" / "hshfit" / name).string());
    }
    paths.push_back(HSHFIT_IMAGE_MODULE);
    return paths;
}

ImageModuleFunction* load() {
    std::string reason = "not found";
    for (const std::string& path : places()) {
        std::error_code error;
        if (!std::filesystem::exists(path, error)) continue;
        if (void* module = dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL)) {
            return reinterpret_cast<ImageModuleFunction*>(dlsym(module, imageModuleFunction));
        }
        if (const char* message = dlerror()) reason = message;
    }
    throw InputError(
        fmt::format("pictures of light cannot be read: the module "
                    "libhshfit_openimageio.so belongs beside the program: {}",
                    reason));
}

}  // namespace

ImageModuleFunction& imageModule() {
    static ImageModuleFunction* function = load();
    return *function;
}

}  // namespace hshfit::inline light
