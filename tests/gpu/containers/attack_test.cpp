// Damaged files: whatever is wrong, readPayload throws InputError with one line, and nothing else.

#include "container_samples.h"

#include <hshfit/error.h>
#include <hshfit/files/checksum.h>

#include <cstring>
#include <functional>
#include <random>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace hshfit::gpu {
namespace {

using Json = nlohmann::ordered_json;
using samples::contentOf;
using samples::Folder;
using samples::put;
using test::exportTo;

class ContainerAttack : public ::testing::Test {
protected:
    static Payload smallPayload(Number number = Number::float16) {
        return pack(samples::asymmetric("hsh", 3, OutgoingSet::parabolic(8, 8), Channels::rgb(), 1),
                    {.number = number});
    }
    /// The file of `container`, and the sidecar beside it.
    std::string exported(const char* container, const ExportOptions& options = {},
                         Number number = Number::float16) {
        const auto files = exportTo(folder.path(), smallPayload(number), {container}, options);
        return folder / files[0].path;
    }
    /// The message of the refusal; empty if the file was read.
    static std::string refusal(const std::string& path) {
        try {
            readPayload(path);
        } catch (const InputError& error) {
            const std::string message = error.what();
            EXPECT_EQ(message.find('\n'), std::string::npos) << message;
            EXPECT_FALSE(message.empty());
            return message;
        }
        return {};
    }
    static void expectRefused(const std::string& path, const std::string& bytes,
                              const std::string& fragment = {}) {
        put(path, bytes);
        const std::string message = refusal(path);
        EXPECT_FALSE(message.empty()) << path << " was read";
        EXPECT_NE(message.find(fragment), std::string::npos) << message;
    }

    const Folder folder;
};

const char* const selfContained[] = {"exr", "exr-parts", "ktx2", "js", "h", "tensor"};

TEST_F(ContainerAttack, EveryTruncationIsRefused) {
    for (const Container& container : containers::catalog()) {
        const std::string path = exported(std::string(container.name).c_str());
        const std::string good = contentOf(path);
        // every length of the head, then steps that meet each part of the rest
        for (std::size_t length = 0; length < good.size();
             length += length < 200 ? 1 : 1 + good.size() / 200) {
            // what follows the array of a header is not needed
            if (container.name == "h" && good.find("};", good.find("_coef[]")) < length) continue;
            if (container.name == "js" && good.find("\";\n") < length) continue;
            expectRefused(path, good.substr(0, length));
        }
    }
    const std::string sidecar = folder / "sample.hsh.json", good = contentOf(sidecar);
    for (std::size_t length = 0; length + 1 < good.size(); length += 1 + good.size() / 1000) {
        expectRefused(sidecar, good.substr(0, length));
    }
}

TEST_F(ContainerAttack, EveryChangedByteIsRefusedOrHarmless) {
    // A change is refused, or it is one that means nothing (padding, a compressor's choice): then
    // the texels are the same, because their SHA-256 is checked.
    const Payload payload = smallPayload();
    for (const Container& container : containers::catalog()) {
        const std::string path = exported(std::string(container.name).c_str());
        const std::string good = contentOf(path);
        std::mt19937_64 random(7);
        for (int i = 0; i < 400; ++i) {
            std::string bad = good;
            const std::size_t at =
                i < 200 ? static_cast<std::size_t>(i) % bad.size() : random() % bad.size();
            bad[at] = static_cast<char>(bad[at] ^ static_cast<char>(1 + random() % 255));
            put(path, bad);
            try {
                const ImportedPayload read = readPayload(path);
                EXPECT_TRUE(read.payload.coefficients.bytes == payload.coefficients.bytes)
                    << container.name << " byte " << at;
            } catch (const InputError& error) {
                EXPECT_EQ(std::strchr(error.what(), '\n'), nullptr) << error.what();
            }
        }
    }
}

/// A 4-byte field of the file replaced.
std::string patched(std::string bytes, std::size_t offset, std::uint32_t value) {
    std::memcpy(bytes.data() + offset, &value, sizeof value);
    return bytes;
}

TEST_F(ContainerAttack, Ktx2FieldsAreChecked) {
    const std::string path = exported("ktx2"), good = contentOf(path);
    const struct {
        std::size_t offset;
        const char* name;
    } fields[] = {{12, "vkFormat"},
                  {20, "pixelWidth"},
                  {24, "pixelHeight"},
                  {28, "pixelDepth"},
                  {32, "layerCount"},
                  {36, "faceCount"},
                  {40, "levelCount"},
                  {44, "supercompressionScheme"},
                  {56, "key/value"},
                  {60, "key/value"},
                  {80, "the level"},
                  {84, "the level"},
                  {88, "the level"},
                  {92, "the level"},
                  {96, "uncompressedByteLength"},
                  {100, "uncompressedByteLength"}};
    for (const auto& [offset, name] : fields) {
        for (const std::uint32_t value : {0x7fffffffU, 0xffffffffU}) {
            expectRefused(path, patched(good, offset, value), name);
        }
        expectRefused(path, patched(good, offset, 3));
    }
    std::uint32_t pairs = 0;
    std::memcpy(&pairs, good.data() + 56, 4);
    expectRefused(path, patched(good, pairs, 0xffffffffU), "keyAndValueByteLength");
    const std::size_t key = good.find("hshfit:sidecar");
    std::string renamed = good;
    renamed[key] = 'x';
    expectRefused(path, renamed, "have no key 'hshfit:sidecar'");
}

TEST_F(ContainerAttack, ZstandardFramesAreChecked) {
    const Payload payload =
        pack(samples::asymmetric("hsh", 3, OutgoingSet::parabolic(16, 16), Channels::rgb(), 1), {});
    exportTo(folder.path(), payload, {"ktx2"}, {.zstd = true});
    const std::string path = folder / "sample.coef.ktx2", good = contentOf(path);
    std::uint64_t level = 0;
    std::memcpy(&level, good.data() + 80, 8);
    ASSERT_EQ(refusal(path), "");
    std::uint32_t scheme = 0;
    std::memcpy(&scheme, good.data() + 44, 4);
    ASSERT_EQ(scheme, 2U) << "not compressed";
    std::string bad = good;
    bad[level] = 'x';
    expectRefused(path, bad, "is no Zstandard frame of");
    bad = good;
    bad[bad.size() - 20] = static_cast<char>(~bad[bad.size() - 20]);
    put(path, bad);
    EXPECT_FALSE(refusal(path).empty());
    // stored as if it were not compressed
    expectRefused(path, patched(good, 44, 0), "byteLength");
}

TEST_F(ContainerAttack, DdsFieldsAreChecked) {
    const std::string path = exported("dds"), sidecar = folder / "sample.hsh.json";
    const std::string good = contentOf(path);
    const Json said = Json::parse(contentOf(sidecar));
    /// With the file's sum and size in the sidecar, so that its own fields are what is looked at.
    const auto write = [&](const std::string& bytes) {
        Json document = said;
        document["files"][0]["sha256"] = sha256(bytes);
        document["files"][0]["bytes"] = bytes.size();
        put(sidecar, document.dump());
        put(path, bytes);
    };
    write(good);
    EXPECT_EQ(refusal(path), "");
    const struct {
        std::size_t offset;
        const char* name;
    } fields[] = {
        {4, "dwSize"},     {12, "dwHeight"}, {16, "dwWidth"},     {28, "dwMipMapCount"},
        {76, "ddspf"},     {84, "dwFourCC"}, {128, "dxgiFormat"}, {132, "resourceDimension"},
        {140, "arraySize"}};
    for (const auto& [offset, name] : fields) {
        for (const std::uint32_t value : {0x7fffffffU, 0xffffffffU, 5U}) {
            write(patched(good, offset, value));
            EXPECT_NE(refusal(path).find(name), std::string::npos) << name << refusal(path);
        }
    }
    write(good + "x");
    EXPECT_NE(refusal(path).find("the texels"), std::string::npos);
    for (std::size_t length = 1; length < 160; ++length) {
        write(good.substr(0, length));
        EXPECT_NE(refusal(path), "") << length;
    }
    // without its own sidecar
    put(path, good);
    std::filesystem::remove(sidecar);
    EXPECT_NE(refusal(path).find("needs its sidecar"), std::string::npos);
}

TEST_F(ContainerAttack, RawFilesAreCheckedAgainstTheirSidecar) {
    const std::string path = exported("bin"), good = contentOf(path);
    expectRefused(path, good + "xx", "has");
    std::string bad = good;
    bad[100] = static_cast<char>(bad[100] ^ 1);
    expectRefused(path, bad, "SHA-256");
    std::filesystem::remove(folder / "sample.hsh.json");
    expectRefused(path, good, "is no file of an export");
    const std::string other = folder / "renamed.bin";
    expectRefused(other, good, "is no file of an export");
}

/// The sidecar of a .bin changed by `edit`, everything else right.
class SidecarAttack : public ContainerAttack {
protected:
    void SetUp() override {
        exported("bin");
        good = Json::parse(contentOf(path()));
    }
    std::string path() const { return folder / "sample.hsh.json"; }
    void expectEdited(const std::string& fragment, const std::function<void(Json&)>& edit) {
        Json document = good;
        edit(document);
        expectRefused(path(), document.dump(), fragment);
    }
    Json good;
};

TEST_F(SidecarAttack, EveryKeyMissingOrOfAnotherTypeIsRefused) {
    // what readers of ours derive themselves
    const std::vector<std::string> unread = {
        "colorspace", "cos_included", "unit",           "lobe",      "frame",     "sum",
        "map",        "sampling",     "clamp_negative", "fit_error", "test_value"};
    std::size_t read = 0;
    for (const auto& [key, value] : good.items()) {
        if (std::find(unread.begin(), unread.end(), key) != unread.end()) continue;
        expectEdited(key == "format" ? "is no file of an export" : key,
                     [&, &name = key](Json& document) { document.erase(name); });
        for (const Json& other :
             {Json(nullptr), Json(-1), Json("x"), Json::array({"x"}), Json::object()}) {
            if (other.type() == value.type()) continue;
            if (key == "basis_textures" && other.is_null()) continue;
            if ((key == "energy" || key == "energy_error" || key == "error") &&
                (other.is_number() || other.is_null())) {
                continue;
            }
            expectEdited("", [&, &name = key](Json& document) { document[name] = other; });
        }
        ++read;
    }
    EXPECT_EQ(read, good.size() - unread.size());
    for (const auto& [key, value] : good["data"].items()) {
        if (key == "index" || key == "range") continue;
        expectEdited(key, [&, &name = key](Json& document) { document["data"].erase(name); });
    }
}

TEST_F(SidecarAttack, SizesThatDoNotFitAreRefused) {
    const auto data = [&](const char* key, const Json& value, const std::string& fragment) {
        expectEdited(fragment, [&](Json& document) { document["data"][key] = value; });
    };
    for (const char* key : {"width", "height", "layers"}) {
        data(key, 0, key);
        data(key, 1e9, key);
        data(key, 1.5, key);
        data(key, 7, "bytes");
    }
    data("bytes", 1, "bytes");
    data("type", "float64", "type");
    data("type", "float32", "bytes");
    data("endian", "big", "endian");
    data("layout", "coef8", "layout");
    data("scale", Json::array(), "scale");
    data("sha256", std::string(64, 'g'), "sha256");
    data("sha256", std::string(64, '0'), "SHA-256");
    // sizes that agree with each other, and with nothing that is there
    expectEdited("bytes", [](Json& document) {
        document["data"]["width"] = document["data"]["height"] = 16384;
        document["data"]["layers"] = 256;
        document["data"]["bytes"] = 16384.0 * 16384 * 256 * 8;
        document["outgoing"]["width"] = document["outgoing"]["height"] = 16384;
    });
    expectEdited("outgoing", [](Json& document) { document["outgoing"]["width"] = 4; });
    expectEdited("outgoing", [](Json& document) {  // as many, but turned
        document["outgoing"]["width"] = 4;
        document["outgoing"]["height"] = 16;
    });
}

TEST_F(SidecarAttack, InconsistentFieldsAreRefused) {
    expectEdited("slots", [](Json& d) { d["basis"]["order"] = 4; });
    expectEdited("order", [](Json& d) { d["basis"]["order"] = 100000; });
    expectEdited("slots", [](Json& d) { std::swap(d["slots"][0], d["slots"][1]); });
    expectEdited("slots", [](Json& d) { d["slots"].erase(8); });
    expectEdited("slots", [](Json& d) { d["slots"] = Json::array(); });
    expectEdited("basis", [](Json& d) { d["basis"]["name"] = "nope"; });
    expectEdited("stored", [](Json& d) { d["stored"].erase(0); });
    expectEdited("first_layer", [](Json& d) { d["stored"][1]["first_layer"] = 1; });
    expectEdited("slots", [](Json& d) { d["stored"][0]["slots"] = 10; });
    expectEdited("layers", [](Json& d) { d["stored"][2]["slots"] = 1; });
    expectEdited("to_channels", [](Json& d) { d["to_channels"][0].erase(0); });
    expectEdited("to_channels", [](Json& d) { d["to_channels"][0][0] = "x"; });
    expectEdited("first_layer", [](Json& d) { d["data"]["layout"] = "rgb"; });
    expectEdited("version", [](Json& d) { d["version"] = 2; });
    expectEdited("export", [](Json& d) { d["format"] = "hshfit-gpux"; });
    expectEdited("tests differ", [](Json& d) { d["tests"][3]["value"][0] = 7; });
    expectEdited("tests differ", [](Json& d) { d["basis"]["condon_shortley"] = true; });
    expectEdited("tests differ",
                 [](Json& d) { std::swap(d["to_channels"][0], d["to_channels"][1]); });
    expectEdited("wi", [](Json& d) { d["tests"][3]["wi"] = {0, 0, -1}; });
    expectEdited("value", [](Json& d) { d["tests"][3]["value"] = {1}; });
}

TEST_F(SidecarAttack, FileEntriesAreChecked) {
    const auto file = [&](const char* key, const Json& value, const std::string& fragment) {
        expectEdited(fragment, [&](Json& document) { document["files"][0][key] = value; });
    };
    for (const char* name : {"../sample.coef.f16.bin", "/etc/passwd", "", "..", ".", "a\\b"}) {
        file("path", name, "path");
    }
    file("path", "absent.bin", "none of its files");
    file("path", "sample.hsh.json", "");
    file("bytes", 5, "the sidecar says 5");
    file("bytes", -1, "bytes");
    file("sha256", std::string(64, '1'), "SHA-256");
    file("role", "texture", "role");
    file("role", "basis", "none of its files");
    file("container", "zip", "container");
    file("container", "dds", "");
    expectEdited("none of its files", [](Json& d) { d["files"] = Json::array(); });
}

TEST_F(ContainerAttack, NumbersThatAreNotFiniteAreRefused) {
    const std::string path = exported("bin"), sidecar = folder / "sample.hsh.json";
    for (const int bits : {0x7c00, 0xfc00, 0x7e00}) {
        const auto half = static_cast<std::uint16_t>(bits);
        std::string bytes = contentOf(path);
        std::memcpy(bytes.data() + 2 * 4 * 9 + 2, &half, 2);  // texel (1, 1), lane 1
        Json document = Json::parse(contentOf(sidecar));
        document["data"]["sha256"] = document["files"][0]["sha256"] = sha256(bytes);
        put(sidecar, document.dump());
        expectRefused(path, bytes, "is not finite at layer 0, row 1, column 1, lane 1");
    }
}

TEST_F(ContainerAttack, ScalesOfNormalisedNumbersAreChecked) {
    exported("bin", {}, Number::unorm8);
    const std::string sidecar = folder / "sample.hsh.json";
    const Json good = Json::parse(contentOf(sidecar));
    Json bad = good;
    bad["data"]["scale"] = nullptr;
    expectRefused(sidecar, bad.dump(), "scale");
    bad = good;
    bad["data"]["scale"].erase(0);
    expectRefused(sidecar, bad.dump(), "scale");
    bad = good;
    bad["data"]["scale"][0] = {1};
    expectRefused(sidecar, bad.dump(), "scale");
    bad = good;
    bad["data"]["scale"][0] = {9e99, 0};
    expectRefused(sidecar, bad.dump(), "");
}

TEST_F(ContainerAttack, NestingAndDoubleKeysAreRefused) {
    const std::string path = folder / "x.hsh.json";
    expectRefused(path, R"({"format":"hshfit-gpu","version":1,"a":)" + std::string(5000, '['),
                  "nested");
    expectRefused(path, R"({"format":"hshfit-gpu","version":1,"version":1})", "twice");
    expectRefused(path, R"({"format":"hshfit-gpu","version":1e999})", "");
    expectRefused(path, "{\"format\":\"hshfit-gpu\",\xff}", "JSON");
}

TEST_F(ContainerAttack, EditedTextsAreReadOrRefused) {
    const std::string header = exported("h"), good = contentOf(header);
    const std::size_t array = good.find("_coef[] = {\n") + 12;
    std::string bad = good;
    bad.replace(array, 6, "0x1234");
    expectRefused(header, bad, "SHA-256");
    bad = good;
    bad.replace(array, 6, "0xzz34");
    expectRefused(header, bad, "number 0 of the array");
    bad = good;
    bad.erase(array, 7);
    expectRefused(header, bad, "of the array");
    const std::string module = exported("js"), text = contentOf(module);
    const std::size_t base64 = text.find("const base64 = \"") + 16;
    bad = text;
    bad[base64 + 5] = '*';
    expectRefused(module, bad, "base64");
    bad = text;
    bad.erase(base64, 4);
    expectRefused(module, bad, "characters of base64");
}

TEST_F(ContainerAttack, OtherFilesAreRefused) {
    const std::string path = folder / "other";
    for (const char* text : {"", "{", "{}", "PNG", "tensor_file", "DDS ", "\x76\x2f\x31\x01",
                             "// hshfit-gpu 1: ", "/* hshfit-gpu 1\n"}) {
        put(path, text);
        EXPECT_NE(refusal(path), "") << text;
    }
    EXPECT_NE(refusal(folder / "absent"), "");
    EXPECT_NE(refusal(folder.path()), "");
    EXPECT_FALSE(looksLikePayload(folder / "absent"));
    EXPECT_FALSE(looksLikePayload(folder.path()));
    EXPECT_FALSE(looksLikePayload("phong:exponent=3"));
    for (const char* container : selfContained) {
        // the magic of one in the folder of another's sidecar
        const std::string file = exported(container);
        EXPECT_TRUE(looksLikePayload(file)) << container;
    }
}

}  // namespace
}  // namespace hshfit::gpu
