#pragma once
#include "sw/trace/sqlite_writer.h"
namespace stereotlm::trace { class VcdWriter : public SqliteWriter { public: using SqliteWriter::SqliteWriter; }; }
