#pragma once

// Names of the library's own interface in its messages. A message that refers to a setting or a
// function formats a `Setting` or a `Call`. A front end with other names, such as the options
// of a program, registers them once (`setWording`), and messages use them.

#include <fmt/format.h>

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hshfit {

/// A member of an options struct, "Struct::member", and the value that is meant, if one is.
struct Setting {
    std::string_view member;
    std::string value = {};
};

/// A function that the reader of the message may call, with what and in which settings; `output` is
/// the file that the result goes to.
struct Call {
    std::string_view function;
    std::string subject = {};
    std::vector<Setting> settings = {};
    std::string output = {};
};

/// The text of a setting and of a call in messages.
struct Wording {
    std::function<std::string(const Setting&)> setting;
    std::function<std::string(const Call&)> call;
};

/// "Struct::member", or "Struct::member = value".
inline std::string asMember(const Setting& setting) {
    std::string text(setting.member);
    return setting.value.empty() ? text : text + " = " + setting.value;
}

/// "function(subject, settings, output)".
inline std::string asFunction(const Call& call) {
    std::string arguments = call.subject;
    const auto add = [&](const std::string& text) {
        if (!text.empty()) arguments += (arguments.empty() ? "" : ", ") + text;
    };
    for (const Setting& setting : call.settings) add(asMember(setting));
    add(call.output);
    return std::string(call.function) + "(" + arguments + ")";
}

/// The wording in use: the names of the library's own interface, unless `setWording` replaced them.
inline Wording& currentWording() {
    static Wording wording{asMember, asFunction};
    return wording;
}

/// Replaces the names above; to be called before any thread uses the library.
inline void setWording(Wording wording) {
    currentWording() = std::move(wording);
}

}  // namespace hshfit

template <>
struct fmt::formatter<hshfit::Setting> : fmt::formatter<std::string> {
    template <class Context>
    auto format(const hshfit::Setting& setting, Context& context) const {
        return fmt::formatter<std::string>::format(hshfit::currentWording().setting(setting),
                                                   context);
    }
};

template <>
struct fmt::formatter<hshfit::Call> : fmt::formatter<std::string> {
    template <class Context>
    auto format(const hshfit::Call& call, Context& context) const {
        return fmt::formatter<std::string>::format(hshfit::currentWording().call(call), context);
    }
};
