#include "option_words.h"

#include <hshfit/accuracy/metrics.h>
#include <hshfit/bases/catalog.h>
#include <hshfit/gpu/containers/targets.h>

#include <brdfs/catalog.h>
#include <brdfs/fit/loss.h>
#include <brdfs/repair.h>

#include <utility>

namespace hshfit::jobs {

std::vector<Word> withAll(std::vector<Word> words) {
    words.push_back({"all", "every one of them"});
    return words;
}

std::vector<Word> basisLists() {
    return withAll(basisWords());
}

std::vector<Word> basisWords() {
    return wordsOf(bases::catalog());
}

std::vector<Word> formWords() {
    return {{"outgoing"}, {"basis"}, {"halfway"}};
}

std::vector<Word> lossWords() {
    return wordsOf(brdfs::losses());
}

std::vector<Word> metricLists() {
    return withAll(metricWords());
}

std::vector<Word> metricWords() {
    return wordsOf(metricCatalog());
}

std::vector<Word> modelWords() {
    return wordsOf(brdfs::models());
}

std::vector<Word> numberWords() {
    return {{"float16"}, {"float32"}, {"unorm16"}, {"unorm8"}};
}

std::vector<Word> precisionWords() {
    return {{"float64"}, {"float32"}, {"half"}, {"unorm16"}, {"unorm8"}};
}

std::vector<Word> repairWords() {
    return withAll(wordsOf(brdfs::repairs()));
}

std::vector<Word> sigmaWords() {
    return {{"column", "of the file"}};
}

std::vector<Word> splitWords() {
    return {{"diffuse", "the constant part"}};
}

std::vector<Word> storageWords() {
    return {{"auto"}, {"constants"}, {"block"}, {"texture"}};
}

std::vector<Word> targetWords() {
    return withAll(summariesOf(gpu::targets()));
}

std::vector<Word> windowWords() {
    return {{"none"}, {"hann"}, {"lanczos"}, {"bending"}};
}

std::vector<Word> writerWords() {
    return wordsOf(brdfs::writers());
}

}  // namespace hshfit::jobs
