#include <hshfit/gpu/containers/containers.h>

#include <hshfit/error.h>
#include <hshfit/gpu/containers/internal/container_files.h>

#include <algorithm>
#include <vector>

#include <fmt/format.h>

namespace hshfit::gpu::inline containers {
namespace {

std::string_view numberTag(Number number) {
    switch (number) {
        case Number::float16:
            return "f16";
        case Number::float32:
            return "f32";
        case Number::unorm16:
            return "u16";
        case Number::unorm8:
            break;
    }
    return "u8";
}

}  // namespace

std::string roleName(Role role) {
    return role == Role::coefficients ? "coef" : "basis";
}

bool Container::holds(Number number) const {
    return std::find(numbers.begin(), numbers.end(), number) != numbers.end();
}

std::string Container::fileName(const std::string& exportName, Role role, Number number) const {
    return fmt::format("{}.{}{}", exportName, roleName(role),
                       fmt::format(fmt::runtime(suffix), numberTag(number)));
}

std::span<const Container> catalog() {
    static const std::vector<Container> table = {
        binContainer(), exrContainer(), exrPartsContainer(), ktx2Container(),
        ddsContainer(), jsContainer(),  headerContainer(),   tensorContainer(),
    };
    return table;
}

const Container& findContainer(std::string_view name) {
    std::string known;
    for (const Container& container : containers::catalog()) {
        if (container.name == name) return container;
        known += fmt::format("{}{}", known.empty() ? "" : ", ", container.name);
    }
    throw UsageError(fmt::format("unknown container '{}'; known: {}", name, known));
}

}  // namespace hshfit::gpu::inline containers
