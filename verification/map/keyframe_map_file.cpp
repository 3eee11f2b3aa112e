// SPDX-License-Identifier: BSD-3-Clause
#include "verification/map/keyframe_map_file.h"

#include <cassert>
#include <cstdint>
#include <string>
#include <utility>

#include "frontend/checksum.h"
#include "frontend/error.h"
#include "frontend/fabmap/model_hash.h"
#include "frontend/state_bytes.h"
#include "verification/map/keyframe_map_rows.h"
#include "verification/map/sqlite.h"

namespace fabloop {
namespace {

using keyframe_map_rows::points_row_of;
using keyframe_map_rows::row_of;
using sqlite::Database;
using sqlite::Statement;
using sqlite::Transaction;

// Points are apart, since they change while the rest of a keyframe stays. Contents are those of keyframe_map_rows, each with its
// checksum, for SQLite has none.
constexpr std::int64_t kApplicationId = 0x46424C4D;  // "FBLM", in the file's head
constexpr std::int64_t kVersion = 4;
constexpr const char* kTables =
    "CREATE TABLE about (model TEXT NOT NULL);"
    "CREATE TABLE session (id INTEGER PRIMARY KEY, content BLOB NOT NULL, checksum INTEGER NOT NULL);"
    "CREATE TABLE keyframe (session INTEGER NOT NULL, frame INTEGER NOT NULL, content BLOB NOT NULL, checksum INTEGER NOT NULL,"
    " UNIQUE (session, frame));"
    "CREATE TABLE points (session INTEGER NOT NULL, frame INTEGER NOT NULL, content BLOB NOT NULL, checksum INTEGER NOT NULL,"
    " UNIQUE (session, frame));";

std::int64_t stored(std::size_t number) { return static_cast<std::int64_t>(number); }
std::int64_t stored_checksum(std::string_view content) { return static_cast<std::int64_t>(checksum(content)); }

void require_this_version(Database& database) {
  if (database.number("PRAGMA application_id") != kApplicationId) throw InputError(database.name() + ": is not a keyframe map");
  const std::int64_t version = database.number("PRAGMA user_version");
  if (version != kVersion) {
    throw InputError(database.name() + ": is a keyframe map of format " + std::to_string(version) + " where this program reads " +
                     std::to_string(kVersion) + "; map again, or use the program that wrote it");
  }
}

void require_model(Database& database, const Model& model) {
  Statement about = database.prepare("SELECT model FROM about");
  const std::string map_model = about.step() ? std::string(about.bytes(0)) : std::string();
  const std::string asked = model_hash(model);
  if (map_model != asked) {
    throw InputError(database.name() + ": was made with another model (" + map_model + ", not " + asked +
                     "), whose words mean something else; give the model that it was made with, or map again");
  }
}

Database opened(const std::filesystem::path& path, const Model& model) {
  if (!std::filesystem::is_regular_file(path)) throw InputError(path.string() + ": there is no such keyframe map");
  Database database(path, Database::Mode::Existing);
  require_this_version(database);
  require_model(database, model);
  return database;
}

/// A row's content, once its checksum was found right.
std::string_view content_of(const Statement& row, int content_column) {
  const std::string_view content = row.bytes(content_column);
  if (stored_checksum(content) != row.integer(content_column + 1)) throw StateDamaged();
  return content;
}

void read_sessions(Database& database, KeyframeMap& map) {
  Statement row = database.prepare("SELECT id, content, checksum FROM session ORDER BY id");
  while (row.step()) {
    if (row.integer(0) != stored(map.sessions.size())) throw StateDamaged();
    map.sessions.push_back(keyframe_map_rows::session_of(content_of(row, 1)));
  }
}

void read_keyframes(Database& database, std::size_t num_words, KeyframeMap& map) {
  Statement row = database.prepare(
      "SELECT k.session, k.frame, k.content, k.checksum, p.content, p.checksum FROM keyframe k JOIN points p"
      " ON p.session = k.session AND p.frame = k.frame ORDER BY k.session, k.frame");
  while (row.step()) {
    const auto session = static_cast<std::size_t>(row.integer(0));
    if (session >= map.sessions.size()) throw StateDamaged();
    MapKeyframe keyframe = keyframe_map_rows::keyframe_of(content_of(row, 2), map.sessions[session].camera);
    keyframe.session = session;
    keyframe_map_rows::set_points(content_of(row, 4), keyframe.view);
    const std::vector<WordId>& words = keyframe.words.words;
    if (stored(keyframe.view.frame) != row.integer(1) || (!words.empty() && words.back() >= num_words)) throw StateDamaged();
    map.keyframes.push_back(std::move(keyframe));
  }
  if (database.number("SELECT count(*) FROM keyframe") != stored(map.keyframes.size())) throw StateDamaged();
}

}  // namespace

struct KeyframeMapFile::Implementation {
  Database database;
  std::size_t num_sessions = 0;        ///< In the file.
  std::size_t num_older_sessions = 0;  ///< Of those, the ones that were there when it was opened.

  void put_session(std::size_t id, const MapSession& session) {
    const std::string content = row_of(session);
    Statement insert = database.prepare("INSERT INTO session VALUES (?, ?, ?)");
    insert.bind(1, stored(id)).bind_bytes(2, content).bind(3, stored_checksum(content)).run();
  }
  void put_keyframe(const MapKeyframe& keyframe) {
    const std::int64_t session = stored(keyframe.session), frame = stored(keyframe.view.frame);
    Statement known = database.prepare("SELECT 1 FROM keyframe WHERE session = ? AND frame = ?");
    if (!known.bind(1, session).bind(2, frame).step()) {
      const std::string content = row_of(keyframe);
      Statement insert = database.prepare("INSERT INTO keyframe VALUES (?, ?, ?, ?)");
      insert.bind(1, session).bind(2, frame).bind_bytes(3, content).bind(4, stored_checksum(content)).run();
    }
    const std::string points = points_row_of(keyframe.view);
    Statement replace = database.prepare("INSERT OR REPLACE INTO points VALUES (?, ?, ?, ?)");
    replace.bind(1, session).bind(2, frame).bind_bytes(3, points).bind(4, stored_checksum(points)).run();
  }
};

KeyframeMapFile::KeyframeMapFile(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
KeyframeMapFile::KeyframeMapFile(KeyframeMapFile&&) noexcept = default;
KeyframeMapFile& KeyframeMapFile::operator=(KeyframeMapFile&&) noexcept = default;
KeyframeMapFile::~KeyframeMapFile() = default;

KeyframeMapFile KeyframeMapFile::create(const std::filesystem::path& path, const KeyframeMap& map) {
  // A file without a byte is what a program leaves that was killed before its first transaction ended.
  if (std::filesystem::exists(path) && !(std::filesystem::is_regular_file(path) && std::filesystem::file_size(path) == 0)) {
    throw InputError(path.string() + ": exists already; give it as the earlier map to go on with it, or remove it");
  }
  auto implementation = std::make_unique<Implementation>(Implementation{Database(path, Database::Mode::New)});
  Database& database = implementation->database;
  database.execute("PRAGMA page_size = 16384");  // rows have hundreds of kilobytes
  Transaction transaction(database, Transaction::Kind::Write);
  database.execute("PRAGMA application_id = " + std::to_string(kApplicationId));
  database.execute("PRAGMA user_version = " + std::to_string(kVersion));
  database.execute(kTables);
  Statement about = database.prepare("INSERT INTO about VALUES (?)");
  about.bind_text(1, map.model_hash).run();
  for (const MapSession& session : map.sessions) implementation->put_session(implementation->num_sessions++, session);
  for (const MapKeyframe& keyframe : map.keyframes) implementation->put_keyframe(keyframe);
  transaction.commit();
  return KeyframeMapFile(std::move(implementation));
}

KeyframeMapFile KeyframeMapFile::open(const std::filesystem::path& path, const Model& model) {
  auto implementation = std::make_unique<Implementation>(Implementation{opened(path, model)});
  const std::int64_t num_sessions = implementation->database.number("SELECT count(*) FROM session");
  implementation->num_sessions = implementation->num_older_sessions = static_cast<std::size_t>(num_sessions);
  return KeyframeMapFile(std::move(implementation));
}

void KeyframeMapFile::put(const KeyframeMap& map, const std::vector<std::size_t>& changed) {
  Implementation& file = *implementation_;
  std::size_t num_sessions = file.num_sessions;
  Transaction transaction(file.database, Transaction::Kind::Write);
  for (const std::size_t place : changed) {
    const MapKeyframe& keyframe = map.keyframes[place];
    if (keyframe.session < file.num_older_sessions || keyframe.session > num_sessions) {
      throw InputError(file.database.name() +
                       ": holds other sessions than the map; read the file and give what it holds to the loop "
                       "closer as the earlier map, or create another file");
    }
    if (keyframe.session == num_sessions) file.put_session(num_sessions++, map.sessions[keyframe.session]);
    file.put_keyframe(keyframe);
  }
  transaction.commit();
  file.num_sessions = num_sessions;
}

KeyframeMap read_keyframe_map(const std::filesystem::path& path, const Model& model) {
  Database database = opened(path, model);
  KeyframeMap map;
  map.model_hash = model_hash(model);
  const Transaction transaction(database, Transaction::Kind::Read);  // one moment, whoever writes
  try {
    read_sessions(database, map);
    read_keyframes(database, model.vocabulary.num_words(), map);
  } catch (const StateDamaged&) {
    throw InputError(path.string() + ": is damaged; take an older copy or map again");
  }
  return map;
}

}  // namespace fabloop
