// rosbag's recorder: it only looks on, and the bags that it writes are noted, to be compared.
#pragma once

namespace move_base_abstract::shim {

/** The variable that names the folder of notes for the program that started this one. */
constexpr const char* kNotesVariable = "MOVE_BASE_ABSTRACT_NOTES";

/**
 * @return whether @p caller is the recorder's thread that waits for messages. Each new message
 * wakes it, so its time-outs need no round. False if the recording has a time limit.
 */
bool isRecordersLook(const void* caller);

/** @return whether the program does nothing but record, for as long as the other nodes go on. */
bool onlyRecords();

/** @brief Note that a file is opened with the mode @p how of fopen(). If it is a bag that is
 * written, its path goes to the notes. */
void noteBag(const char* path, const char* how, const void* caller);

}  // namespace move_base_abstract::shim
