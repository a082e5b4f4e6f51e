#include <hshfit/gpu/language_words.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cctype>

namespace hshfit::gpu {
namespace {

using kainjow::mustache::data;

/// The words of a language from which the others follow.
struct Words {
    std::string vec2, vec3, vec4;
    std::string real = "float", whole = "int";
    std::string toReal = real, toInt = whole;
    /// Declarations begin with `let` and `var`, not with a type, and there are no macros.
    bool inferred = false;
};

Words wordsOf(Language language, const std::string& prefix) {
    const LanguageTexts families{"glsl", "glsl", "hlsl", "wgsl", "hlsl", "osl"};
    const std::string_view family = textOf(language, families);
    if (family == "glsl") return {.vec2 = "vec2", .vec3 = "vec3", .vec4 = "vec4"};
    if (family == "hlsl") return {.vec2 = "float2", .vec3 = "float3", .vec4 = "float4"};
    if (family == "wgsl") {
        return {.vec2 = "vec2<f32>",
                .vec3 = "vec3<f32>",
                .vec4 = "vec4<f32>",
                .real = "f32",
                .whole = "i32",
                .inferred = true};
    }
    return {.vec2 = prefix + "_Two",
            .vec3 = "vector",
            .vec4 = prefix + "_Four",
            .toReal = "(float)",
            .toInt = "(int)"};
}

}  // namespace

std::string_view textOf(Language language, const LanguageTexts& texts) {
    switch (language) {
        case Language::glslEs:
            return texts.glslEs;
        case Language::glsl:
            return texts.glsl;
        case Language::hlsl:
        case Language::slang:
            return texts.hlsl;
        case Language::wgsl:
            return texts.wgsl;
        case Language::metal:
            return texts.metal;
        case Language::osl:
            break;
    }
    return texts.osl;
}

void setLanguageWords(Language language, const std::string& prefix, data& page) {
    const Words words = wordsOf(language, prefix);
    const std::string name(textOf(language, {"glslEs", "glsl", "hlsl", "wgsl", "metal", "osl"}));
    for (const char* each : {"glslEs", "glsl", "hlsl", "wgsl", "metal", "osl"})
        page.set(each, name == each);
    const auto declare = [&](const char* suffix, const std::string& type) {
        page.set(std::string("let") + suffix, words.inferred ? "let" : type);
        page.set(std::string("var") + suffix, words.inferred ? "var" : type);
    };
    declare("", words.real);
    declare("2", words.vec2);
    declare("3", words.vec3);
    declare("4", words.vec4);
    declare("Int", words.whole);
    page.set("real", words.real);
    page.set("vec2", words.vec2);
    page.set("vec3", words.vec3);
    page.set("vec4", words.vec4);
    page.set("int", words.whole);
    page.set("toReal", words.toReal);
    page.set("toInt", words.toInt);
    page.set("atan2", name.starts_with("glsl") ? "atan" : "atan2");
    page.set("dot", name == "osl" ? prefix + "_dot" : "dot");
    page.set("inline", name == "metal" ? "inline " : "");
    page.set("env", name == "metal" ? "env.sh" : "env");
    page.set("light", name == "metal" ? "light.sh" : "light");
    std::string upper = prefix;
    for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    page.set("prefix", prefix);
    page.set("PREFIX", upper);
    page.set("texel", words.inferred ? prefix + "_texel" : upper + "_TEXEL");
    page.set("basisTexel", words.inferred ? prefix + "_basisTexel" : upper + "_BASIS_TEXEL");
}

void setChannelWords(const Channels& channels, data& page) {
    const bool grey = channels.kind == Channels::Kind::grey;
    const bool spectral = channels.kind == Channels::Kind::spectral;
    page.set("grey", grey);
    page.set("colour", !grey && !spectral);
    page.set("spectral", spectral);
    page.set("channelCount", std::to_string(channels.count()));
    page.set("channelNames", fmt::format("{}", fmt::join(channels.names(), " ")));
    page.set("type", spectral ? wordOf(page, "prefix") + "_Values"
                     : grey   ? wordOf(page, "real")
                              : wordOf(page, "vec3"));
    page.set("zero", grey ? "0.0" : wordOf(page, "vec3") + "(0.0, 0.0, 0.0)");
}

std::string wordOf(const data& page, const std::string& key) {
    return page.get(key)->string_value();
}

}  // namespace hshfit::gpu
