#pragma once

// Members of options structs, in which front ends read defaults and set values.

#include <cstddef>
#include <optional>
#include <string>
#include <type_traits>
#include <typeinfo>
#include <variant>
#include <vector>

namespace hshfit::jobs {

/// A member that is read and set as a word, such as an enumeration; "" stands for none.
struct Spelled {
    void* at;
    std::string (*word)(const void* at);
    void (*set)(void* at, const std::string& word);  ///< throws UsageError
};

/// A member of an options struct, where front ends read its default and set its value.
using OptionValue = std::variant<bool*, std::optional<bool>*, int*, std::size_t*, double*,
                                 std::optional<std::size_t>*, std::optional<double>*, std::string*,
                                 std::vector<std::string>*, std::vector<int>*,
                                 std::vector<std::size_t>*, std::vector<double>*, Spelled>;

/// The way to the member in a struct of the type `owner`.
struct Member {
    const std::type_info* owner;
    OptionValue (*in)(void* options);
};

namespace options {

template <class Struct, class Value>
Struct ownerOf(Value Struct::*member);

template <class Struct>
auto& memberOf(Struct& options, auto first, auto... rest) {
    if constexpr (sizeof...(rest) == 0)
        return options.*first;
    else
        return memberOf(options.*first, rest...);
}

template <auto First, auto... Rest>
auto& memberIn(void* options) {
    using Struct = decltype(ownerOf(First));
    return memberOf(*static_cast<Struct*>(options), First, Rest...);
}

/// A member, or a member of a member.
template <auto First, auto... Rest>
constexpr Member at = {&typeid(decltype(ownerOf(First))), [](void* options) -> OptionValue {
                           return &memberIn<First, Rest...>(options);
                       }};

template <class Type>
concept Optional = requires(Type& value) {
    value.reset();
};

/// For `spelled`: the default has no word, or is told in words (OptionRow::fallback).
template <class Type>
std::string untold(const Type&) {
    return {};
}

/// As `at`, for a member that `parse` reads and `name` writes as a word.
template <auto parse, auto name, auto First, auto... Rest>
constexpr Member spelled = {
    &typeid(decltype(ownerOf(First))), [](void* options) -> OptionValue {
        auto& member = memberIn<First, Rest...>(options);
        using Type = std::remove_reference_t<decltype(member)>;
        return Spelled{&member,
                       [](const void* at) {
                           const auto& value = *static_cast<const Type*>(at);
                           if constexpr (Optional<Type>)
                               return value ? std::string(name(*value)) : std::string();
                           else
                               return std::string(name(value));
                       },
                       [](void* at, const std::string& word) {
                           auto& value = *static_cast<Type*>(at);
                           if constexpr (Optional<Type>) {
                               if (word.empty()) return value.reset();
                           }
                           value = parse(word);
                       }};
    }};

}  // namespace options

}  // namespace hshfit::jobs
