#include <hshfit/error.h>
#include <hshfit/picture_files/internal/image_module.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <dlfcn.h>

#include <filesystem>

namespace hshfit::inline picture_files {
namespace {

constexpr std::string_view moduleName = "libhshfit_openimageio.so";

/// Beside the program, in the library folder of its installation, by the loader's own rules (the
/// run path of the program, LD_LIBRARY_PATH), and where this project is usually installed.
std::vector<std::string> places() {
    const std::string name(moduleName);
    std::vector<std::string> paths;
    std::error_code error;
    const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
    if (!error) {
        const auto folder = program.parent_path();
        paths.push_back((folder / name).string());
        paths.push_back((folder.parent_path() / "lib" / "hshfit" / name).string());
    }
    paths.push_back(name);
#ifdef HSHFIT_IMAGE_MODULE
    paths.push_back(HSHFIT_IMAGE_MODULE);
#endif
    for (const std::string prefix : {"/usr/local", "/usr"})
        paths.push_back(prefix + "/lib/hshfit/" + name);
    return paths;
}

ImageModuleFunction* load() {
    std::string reason = "not found";
    for (const std::string& path : places()) {
        std::error_code error;
        if (path != moduleName && !std::filesystem::exists(path, error)) continue;
        if (void* module = dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL)) {
            return reinterpret_cast<ImageModuleFunction*>(dlsym(module, imageModuleFunction));
        }
        const char* message = dlerror();
        if (message && std::filesystem::exists(path, error)) reason = message;
    }
    throw InputError(
        fmt::format("pictures cannot be read: the module "
                    "libhshfit_openimageio.so (Debian package hshfit-pictures) belongs beside "
                    "the program or in ../lib/hshfit: {}",
                    reason));
}

}  // namespace

ImageModuleFunction& imageModule() {
    static ImageModuleFunction* function = load();
    return *function;
}

}  // namespace hshfit::inline picture_files
