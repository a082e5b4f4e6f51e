#pragma once

// Rows of the options of commands, for the table of commands.

#include <jobs/common/option_row.h>

#include <span>
#include <vector>

namespace hshfit::cli {

using OptionTables = std::vector<std::span<const jobs::OptionRow>>;

OptionTables batchRows();
OptionTables chooseRows();
OptionTables compareRows();
OptionTables convertRows();
OptionTables evalRows();
OptionTables exportRows();
OptionTables fitRows();
OptionTables gaussianRows();
OptionTables illuminateRows();
OptionTables importRows();
OptionTables infoRows();
OptionTables irradianceRows();
OptionTables libraryRows();
OptionTables lightRows();
OptionTables ltcRows();
OptionTables matrixRows();
OptionTables planRows();
OptionTables plotRows();
OptionTables projectRows();
OptionTables renderRows();
OptionTables reportRows();
OptionTables rotateRows();
OptionTables sampleRows();
OptionTables stressRows();
OptionTables svbrdfRows();
OptionTables tradeoffRows();
OptionTables transferRows();

}  // namespace hshfit::cli
