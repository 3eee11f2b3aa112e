// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

/// As much of SQLite as map files need (private). Every failure is an InputError that names the file.
namespace fabloop::sqlite {

struct CloseDatabase {
  void operator()(sqlite3* database) const;
};
struct CloseStatement {
  void operator()(sqlite3_stmt* statement) const;
};

class Statement;

class Database {
 public:
  enum class Mode {
    Existing,
    New,  ///< Created where there is none.
  };

  Database(const std::filesystem::path& path, Mode mode);

  /// Runs SQL without results, one or several commands.
  void execute(const std::string& sql);
  Statement prepare(std::string_view sql);

  /// The only number that a query gives.
  std::int64_t number(std::string_view sql);

  const std::string& name() const { return name_; }

  /// Throws what the last call failed with.
  [[noreturn]] void fail(int code) const;

 private:
  std::string name_;
  std::unique_ptr<sqlite3, CloseDatabase> handle_;
};

/// One command with parameters, numbered from 1; columns are numbered from 0. The database must outlive it.
class Statement {
 public:
  Statement(Database& database, sqlite3_stmt* statement) : database_(&database), statement_(statement) {}

  Statement& bind(int parameter, std::int64_t value);
  Statement& bind_text(int parameter, std::string_view text);  ///< Which must stay until the statement has run.
  Statement& bind_bytes(int parameter, std::string_view bytes);

  /// Whether there is another row.
  bool step();
  void run();  ///< To its end, ready to be bound again.

  std::int64_t integer(int column) const;
  std::string_view bytes(int column) const;  ///< Text or blob; valid until the next step.

 private:
  Database* database_;
  std::unique_ptr<sqlite3_stmt, CloseStatement> statement_;
};

/// What happens until commit() happens as a whole or not at all, whenever the program is killed.
class Transaction {
 public:
  enum class Kind { Read, Write };

  Transaction(Database& database, Kind kind);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;

  void commit();

 private:
  Database* database_;
  bool is_open_ = true;
};

}  // namespace fabloop::sqlite
