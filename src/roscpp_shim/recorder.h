// rosbag's recorder: it only looks on, and what it writes is told, so that it can be compared.
#ifndef MOVE_BASE_ABSTRACT_ROSCPP_SHIM_RECORDER_H
#define MOVE_BASE_ABSTRACT_ROSCPP_SHIM_RECORDER_H

namespace move_base_abstract::shim {

/**
 * @return whether the recorder's thread looks for messages, which whoever brings one tells it: its
 * time-outs are worth no round. Not where the recording is to end, or be split, after a while.
 */
bool isRecordersLook(const void* caller);

/** @return whether the program is one that does nothing but record, for as long as others go on. */
bool onlyRecords();

/** @brief A file is opened as @p how says, as of fopen(): a bag that is written is noted for who
 * has started the program (MOVE_BASE_ABSTRACT_BAGS names a file for that). */
void noteBag(const char* path, const char* how, const void* caller);

}  // namespace move_base_abstract::shim

#endif  // MOVE_BASE_ABSTRACT_ROSCPP_SHIM_RECORDER_H
