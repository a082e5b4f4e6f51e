#include "command.h"
#include "run_words.h"
#include "wording.h"

#include <hshfit/files/atomic_file.h>

#include <algorithm>
#include <string>
#include <vector>

int main(int argc, char** argv) {
    hshfit::cli::occupyStandardStreams();
    hshfit::removeTemporariesOnSignals();
    hshfit::cli::endUncaughtInOneLine();
    hshfit::setWording(hshfit::cli::optionWording());
    return hshfit::cli::runWords(std::vector<std::string>(argv + std::min(argc, 1), argv + argc));
}
