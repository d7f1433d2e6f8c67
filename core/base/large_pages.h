#pragma once
// Memory for large arrays that are accessed all over.

#include <sys/mman.h>

#include <cstdlib>
#include <new>

namespace ulam {

/// Asks the system for large pages (2 MB), so that an access seldom waits for an address to be translated.
template <class T>
struct LargePageAllocator {
    using value_type = T;
    LargePageAllocator() = default;
    template <class U>
    LargePageAllocator(const LargePageAllocator<U>&) {}

    T* allocate(size_t n) {
        constexpr size_t kPage = size_t(2) << 20;
        const size_t bytes = n * sizeof(T);
        if (bytes < kPage) return static_cast<T*>(::operator new(bytes));
        void* p = std::aligned_alloc(kPage, (bytes + kPage - 1) / kPage * kPage);
        if (!p) throw std::bad_alloc();
        madvise(p, bytes, MADV_HUGEPAGE);  // advice: where it is not taken, nothing is lost
        return static_cast<T*>(p);
    }
    void deallocate(T* p, size_t n) {
        if (n * sizeof(T) < (size_t(2) << 20)) ::operator delete(p);
        else std::free(p);
    }
    friend bool operator==(const LargePageAllocator&, const LargePageAllocator&) { return true; }
};

}  // namespace ulam
