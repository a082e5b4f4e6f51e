// Damaged BSDF XML ends in one clear line with the line number.

#include "bsdf_xml_files.h"

#include <limits>

namespace hshfit {
namespace {

using namespace test;

const std::vector<KlemsRing> two{{0, 45, 1}, {45, 90, 2}};

std::string klems(const std::string& data = "1 2 3 4 5 6 7 8 9") {
    return bsdfXml("Columns", basisXml("Two", two), blockXml("Reflection Front", data, "Two"));
}
std::string tree(const std::string& data, int rank = 3) {
    return bsdfXml("TensorTree" + std::to_string(rank), "",
                   blockXml("Reflection Front", data, "LBNL/Shirley-Chiu"));
}
void expectRefused(const std::string& xml, const std::vector<std::string>& parts) {
    expectInputError(
        [&] {
            const auto brdf = openBytes(xml);
            brdf->checkIntact();
        },
        parts);
}
std::string replaced(std::string text, const std::string& what, const std::string& with) {
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return text.replace(at, what.size(), with);
}

TEST(BsdfXmlAttack, EveryTruncationIsRefused) {
    const std::string matrix = klems(), three = tree("{{1}{2}{3}{4}{5}{6}{7}{1 2 3 4 5 6 7 8}}");
    EXPECT_NO_THROW(openBytes(matrix));
    EXPECT_NO_THROW(openBytes(three));
    for (const std::string& whole : {matrix, three}) {
        const std::size_t end = whole.rfind("</WindowElement>") + 16;
        for (std::size_t size = 0; size < end; ++size) {
            expectRefused(whole.substr(0, size), {"memory: line "});
        }
    }
}

TEST(BsdfXmlAttack, DocumentTypesAreRefused) {
    const std::string bomb =
        "<!DOCTYPE WindowElement [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;&a;&a;\">]>";
    for (const char* at : {"<WindowElement", "<Optical>"}) {
        expectRefused(replaced(klems(), at, bomb + at), {"document type", "memory: line "});
    }
    expectRefused(replaced(klems(), "1 2 3", "1 2 &a;"), {"no number", "memory: line "});
}

TEST(BsdfXmlAttack, NestingAndSizesAreLimited) {
    std::string deep, open, many;
    for (int k = 0; k < 2'000'000; ++k) deep += "<a>";
    for (int k = 0; k < 100'001; ++k) many += "<a/>";
    expectRefused(deep, {"more than 32 elements within each other", "line 1:"});
    expectRefused(replaced(klems(), "<Layer>", "<Layer>" + deep), {"more than 32 elements"});
    expectRefused(replaced(klems(), "<Layer>", "<Layer>" + many), {"more than 100000 elements"});
    expectRefused(tree(std::string(5'000'000, '{')), {"more than 10 levels"});
    expectRefused(tree(std::string(12, '{')), {"more than 10 levels"});
    std::string grid = "{";
    for (int k = 0; k < 512; ++k) grid += " 1";  // three levels at once
    std::string nested = grid + "}";
    for (int k = 0; k < 7; ++k) nested = "{" + nested + "{1}{1}{1}{1}{1}{1}{1}}";
    EXPECT_NO_THROW(openBytes(tree(nested)));
    expectRefused(tree("{" + nested + "{1}{1}{1}{1}{1}{1}{1}}"), {"more than 10 levels"});
}

TEST(BsdfXmlAttack, CountsAreChecked) {
    expectRefused(klems("1 2 3 4 5 6 7 8"), {"8 values for 3 x 3 patches", "expected 9"});
    expectRefused(klems("1 2 3 4 5 6 7 8 9 10"), {"10 values"});
    expectRefused(klems(""), {"0 values"});
    expectRefused(replaced(klems(), "<nPhis>2", "<nPhis>1e300"), {"nPhis", "from 0 to 1024"});
    expectRefused(replaced(klems(), "<nPhis>2", "<nPhis>-2"), {"nPhis"});
    expectRefused(replaced(klems(), "<nPhis>2", "<nPhis>1.5"), {"whole number"});
    expectRefused(replaced(klems(), "<nPhis>2", "<nPhis>0"), {"whole number"});
    expectRefused(replaced(klems(), "<nPhis>2", "<nPhis>2x"), {"nPhis is '2x'"});
    expectRefused(replaced(klems(), "<LowerTheta>45", "<LowerTheta>44"), {"a ring from 44"});
    expectRefused(replaced(klems(), "<UpperTheta>90", "<UpperTheta>95"), {"UpperTheta"});
    expectRefused(replaced(klems(), "<UpperTheta>90", "<UpperTheta>nan"), {"UpperTheta"});
    expectRefused(replaced(klems(), "<UpperTheta>90", "<UpperTheta>40"), {"a ring from"});
    std::vector<KlemsRing> rings;
    for (int k = 0; k < 3; ++k) rings.push_back({30.0 * k, 30.0 * (k + 1), 1000});
    expectRefused(
        bsdfXml("Columns", basisXml("Two", rings), blockXml("Reflection Front", "", "Two")),
        {"2048 patches"});
    expectRefused(tree("{ 1 2 }"), {"2 values between braces", "1, 8 or another power of 8"});
    expectRefused(tree("{ }"), {"0 values"});
    expectRefused(tree("{{1}{1}{1}{1}{1}{1}{1}}"), {"'}' after 7 trees", "expected 8"});
    expectRefused(tree("{{1}{1}{1}{1}{1}{1}{1}{1}{1}}"), {"expected '}'"});
    expectRefused(tree("{1} {1}"), {"'{1}' after the tensor tree"});
    expectRefused(tree("1"), {"expected '{'"});
    expectRefused(tree("{1"), {"the end of the data", "expected '}'"});
}

TEST(BsdfXmlAttack, NumbersAreChecked) {
    expectRefused(klems("1 2 3 4 x 6 7 8 9"), {"'x' is no number"});
    expectRefused(klems("1 2 3\n4 5.5.5 6 7 8 9"), {"'5.5.5' is no number"});
    expectRefused(klems("1 2 3 4 5e40 6 7 8 9"), {"'5e40' is too large"});
    expectRefused(klems("1 2 3,,4 5 6 7 8 9"), {"is no number"});
    expectRefused(klems("1 2 3 4 {5} 6 7 8 9"), {"'{5}' among the numbers"});
    expectRefused(klems("1 2 3 nan 5 6 7 8 9"), {"NaN or infinite", "memory: line "});
    expectRefused(klems("1 2 3 inf 5 6 7 8 9"), {"NaN or infinite"});
    expectRefused(klems("1 2 3 1e999 5 6 7 8 9"), {"NaN or infinite"});
    expectRefused(tree("{ nan }"), {"NaN or infinite"});
    expectRefused(klems("1 2 3 <!-- here --> 4 5 6 7 8 9"), {"interrupted"});
    expectRefused(klems("1 2 3 <b/> 4 5 6 7 8 9"), {"interrupted"});
    expectRefused(replaced(klems(), "1 2 3", std::string("1 2\0 3", 6)), {"zero byte"});
    EXPECT_NO_THROW(openBytes(klems("\n1,\r\n2,3,-4,5\t6 7 +8 1e-999,")));
}

TEST(BsdfXmlAttack, TheLineIsTheOneInTheFile) {
    const std::string xml = klems("1 2 3\n4 oops 6\n7 8 9");
    const auto line = 1 + std::count(xml.begin(), xml.begin() + xml.find("oops"), '\n');
    expectRefused(xml, {"memory: line " + std::to_string(line) + ":"});
}

TEST(BsdfXmlAttack, ElementsAndWordsAreChecked) {
    expectRefused("<a/>", {"outermost element is not WindowElement"});
    expectRefused("no xml", {"memory: line 1"});
    expectRefused("", {"memory: line 1"});
    expectRefused("<WindowElement/>", {"no Optical"});
    expectRefused("<WindowElement><Optical/></WindowElement>", {"no Layer"});
    expectRefused(
        replaced(replaced(klems(), "<DataDefinition>", "<D>"), "</DataDefinition>", "</D>"),
        {"no DataDefinition"});
    expectRefused(replaced(klems(), ">Columns<", ">Diagonals<"),
                  {"'Diagonals'", "expected Columns"});
    expectRefused(replaced(klems(), "BasisName>Two", "BasisName>Three"),
                  {"'Two' is neither defined", "LBNL/Klems Full"});
    expectRefused(replaced(klems(), "Reflection Front", "Reflection Sideways"),
                  {"no block Reflection Front", "Reflection Sideways"});
    expectRefused(replaced(tree("{1}"), "LBNL/Shirley-Chiu", "LBNL/Tregenza"), {"'LBNL/Tregenza'"});
    const std::string block = blockXml("Reflection Front", "1 2 3 4 5 6 7 8 9", "Two");
    expectRefused(bsdfXml("Columns", basisXml("Two", two), block + block), {"a second block"});
    expectRefused(bsdfXml("Columns", basisXml("Two", two), ""), {"no WavelengthDataBlock"});
    expectRefused(replaced(klems(), "</Optical>", "</Optica>"), {"not valid XML"});
    // A quotation stays one short line.
    expectRefused(replaced(klems(), ">Columns<", ">a\nb" + std::string(5000, 'x') + "<"), {"a b"});
}

TEST(BsdfXmlAttack, RandomDamageIsFiniteOrRefused) {
    const std::string seeds[] = {klems(), tree("{{1}{2}{3}{4}{5}{6}{7}{1 2 3 4 5 6 7 8}}"),
                                 tree("{0.5}", 4)};
    std::mt19937 random(13);
    int opened = 0, refused = 0;
    for (int k = 0; k < 6000; ++k) {
        std::string xml = seeds[k % 3];
        for (int n = 0; n <= k % 3; ++n) {
            xml[random() % xml.size()] = "<>{}/ 0129.-&;eEnN\"\n"[random() % 20];
        }
        try {
            const auto brdf = openBytes(xml);
            for (const Direction& d : {Direction{}, {0.6, 0, 0.8}, {0, -1, 1e-12}}) {
                for (const double f : evaluate(*brdf, d, {-0.8, 0, 0.6})) {
                    ASSERT_TRUE(f >= 0 && std::isfinite(f));
                }
            }
            ++opened;
        } catch (const InputError&) {
            ++refused;
        }
    }
    EXPECT_GT(opened, 100);
    EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace hshfit
