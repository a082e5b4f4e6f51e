#include <hshfit/pages/gnuplot.h>

#include "lib/coefficient_files/coefficient_samples.h"
#include "places.h"

#include <gtest/gtest.h>

#include <cstdlib>

using namespace hshfit;
using hshfit::samples::contentOf;
using hshfit::samples::Folder;
using hshfit::samples::put;

namespace {

TEST(Gnuplot, StringsArriveByteByByte) {
    if (!hshfit::test::hasGnuplot()) GTEST_SKIP() << hshfit::test::noGnuplot;
    const Folder folder;
    std::string all;
    for (int c = 1; c < 256; ++c) all += static_cast<char>(c);
    for (const std::string& text :
         {all, std::string("''a"), std::string("'"), std::string("\"`'\\"), std::string("a''b''"),
          std::string("`date`"), std::string()}) {
        const std::string out = folder / "out";
        runGnuplot(folder.path().string(),
                   {"-e", "set print " + gnuplotString(out) + "; print " + gnuplotString(text)},
                   {});
        EXPECT_EQ(contentOf(out), text + "\n");
    }
}

TEST(Gnuplot, FiguresGoToFilesOfAnyName) {
    if (!hshfit::test::hasGnuplot()) GTEST_SKIP() << hshfit::test::noGnuplot;
    const Folder folder;
    for (const std::string name : {"''", "'a", "a''b", "\"b\"", "`c`", "d\\e", "f\xff", "g\n"}) {
        std::filesystem::create_directory(folder / name);
        const std::string path = (folder / name) + "/" + name + ".svg";
        const AtomicFile file(path);
        runGnuplot(folder / name,
                   {"-e", gnuplotFile("svg", file) +
                              "set terminal svg; set output svg; plot x; set output"},
                   {file.temporaryPath()});
        EXPECT_TRUE(figureIsComplete(file.temporaryPath())) << name;
    }
}

TEST(Gnuplot, FiguresAreCompleteAtTheirEndsOnly) {
    const Folder folder;
    const auto complete = [&](std::string_view bytes) {
        put(folder / "figure", std::string(bytes));
        return figureIsComplete(folder / "figure");
    };
    // The last chunk of every PNG file: no bytes, its name and its CRC (PNG, 11.2.5).
    const std::string_view png("\x89PNG\r\n\x1a\n\0\0\0\0IEND\xae\x42\x60\x82", 20);
    for (const std::string_view whole : {png, std::string_view("%PDF-1.5\nstartxref\n9\n%%EOF\n"),
                                         std::string_view("<svg><g></g>\n</svg>\n\n")}) {
        const std::size_t end = whole.find_last_not_of("\r\n") + 1;
        for (std::size_t length = 0; length < end; ++length) {
            EXPECT_FALSE(complete(whole.substr(0, length))) << length;
        }
        EXPECT_TRUE(complete(whole));
    }
    EXPECT_FALSE(figureIsComplete(folder / "none"));
}

}  // namespace
