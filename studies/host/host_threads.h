// The threads that the system lets this process have.
#pragma once

namespace marti::studies::host {

/// Finds out, by starting some, whether as many threads can be made as there are processors, for oneTBB and
/// again for the workers of a sweep. If they cannot (a limit of processes, of a container's tasks, or of
/// address space), tells oneTBB to take fewer, because it would abort the program. Call it once, before the
/// first parallel work; results are the same with any number.
void limit_threads_to_available();

}  // namespace marti::studies::host
