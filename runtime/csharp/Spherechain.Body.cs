// SPDX-License-Identifier: MIT
// A Body: a model in a pose, and the questions that are asked about it, with a Query for their options. Results are lists that
// stay and only grow: once they are as long as the largest frame needs, no question allocates.
using System;
using System.Runtime.InteropServices;
using System.Threading;

namespace Spherechain
{
    /// <summary>The answer to a question: the first Count of Items. The body's next question of the same kind overwrites it. Total
    /// is larger where there was no room, or Query.Limit is less.</summary>
    public sealed class Results<T> where T : struct
    {
        public T[] Items { get; private set; }
        public int Count { get; private set; }
        public int Total { get; private set; }
        public T this[int i] { get { return Items[i]; } }

        public Results() { Items = new T[0]; }

        /// <summary>Keeps what the next question would overwrite.</summary>
        public void CopyFrom(Results<T> other)
        {
            Resize(other.Count, other.Total);
            Array.Copy(other.Items, Items, Count);
        }

        internal unsafe void CopyFrom(void* from, UIntPtr count, UIntPtr total)
        {
            Resize(Text.Int(count), Text.Int(total));
            if (Count == 0) return;
            GCHandle pin = GCHandle.Alloc(Items, GCHandleType.Pinned);
            long bytes = (long)Count * kSize;
            Buffer.MemoryCopy(from, (void*)pin.AddrOfPinnedObject(), bytes, bytes);
            pin.Free();
        }

        void Resize(int count, int total)
        {
            if (count > Items.Length) Items = new T[Math.Max(count, 2 * Items.Length)];
            Count = count;
            Total = total;
        }

        static readonly int kSize = Marshal.SizeOf(typeof(T));

        public Enumerator GetEnumerator() { return new Enumerator { items = Items, count = Count, at = -1 }; }

        /// <summary>For `foreach`, which allocates nothing.</summary>
        public struct Enumerator
        {
            internal T[] items;
            internal int count, at;
            public bool MoveNext() { return ++at < count; }
            public T Current { get { return items[at]; } }
        }
    }

    /// <summary>Body parts that touch, and with Query.Full spheres and triangles, too. Sorted, each once.</summary>
    public sealed class Contacts
    {
        public readonly Results<PartContact> Parts = new Results<PartContact>();
        public readonly Results<Pair> Spheres = new Results<Pair>();
        public readonly Results<TriangleContact> Triangles = new Results<TriangleContact>();
        public Results<PartContact>.Enumerator GetEnumerator() { return Parts.GetEnumerator(); }
    }

    public sealed class SpherePairs
    {
        /// <summary>The asset's, in the pose.</summary>
        public readonly Results<Sphere> Spheres = new Results<Sphere>();
        public readonly Results<Pair> Pairs = new Results<Pair>();
    }

    /// <summary>A plane: up . p = height on it. Up is of unit length.</summary>
    public struct Ground
    {
        public Vec3 Up;
        public float Height;
    }

    /// <summary>The pairs of spheres that a question about one body leaves out: the asset's own at first.</summary>
    public sealed unsafe class IgnoredPairs
    {
        internal readonly ulong[] Words;
        readonly Model model;

        public IgnoredPairs(Model model)
        {
            Text.Require(model, Field.Asset, "the model");
            this.model = model;
            Words = new ulong[Text.Int(Native.sc_pair_words(model.Asset))];
            ulong* own = Native.sc_asset_get_info(model.Asset).IgnoredPairs;
            for (int i = 0; i < Words.Length; ++i) Words[i] = own[i];
            GC.KeepAlive(model);
        }

        /// <summary>`isIgnored` false reports the pair, also where the asset itself ignores it.</summary>
        public void IgnorePair(uint a, uint b, bool isIgnored)
        {
            ulong low = Math.Min(a, b), high = Math.Max(a, b), bit = high * (high - 1) / 2 + low;
            if (a == b || high >= (ulong)model.SphereCount) throw new SpherechainException(Code.BadValue, Field.Index, "two different spheres");
            ulong mask = 1UL << (int)(bit % 64);
            Words[bit / 64] = isIgnored ? Words[bit / 64] | mask : Words[bit / 64] & ~mask;
        }

        /// <summary>Each pair of a sphere of one body part with a sphere of the other.</summary>
        public void IgnoreParts(int part, int other, bool isIgnored)
        {
            fixed (ulong* words = Words)
            {
                Text.Check(Native.sc_ignore_parts(model.Asset, words, Text.Size(part), Text.Size(other), isIgnored ? 1 : 0));
            }
            GC.KeepAlive(model);
        }
    }

    /// <summary>The options of a question; default(Query) asks what `spherechain play` and `check` ask.</summary>
    public struct Query
    {
        public const uint AllClasses = uint.MaxValue;

        public Scope Scope;
        /// <summary>Penetrations that are no faults are measured in full, too; contacts are of spheres and triangles.</summary>
        public bool Full;
        /// <summary>Of a body with itself; null: the asset's ignored pairs.</summary>
        public IgnoredPairs IgnoredPairs;
        /// <summary>Model.PartSet(): of two bodies, parts that meet nothing: a hand that holds the other.</summary>
        public ulong[] IgnoredParts, IgnoredPartsOfOther;
        /// <summary>Model.PairSet(): of contacts and penetrations, the pairs of parts that are asked about; null: all.</summary>
        public ulong[] PartPairs;
        /// <summary>What is a fault; null: Native.sc_default_rule().</summary>
        public Rule? Rule;
        /// <summary>Bit k: penetrations of class k are listed; 0: faults alone.</summary>
        public uint Classes;
        /// <summary>The worst so many; 0: as many as there is room for.</summary>
        public int Limit;
        /// <summary>The penetrations of the frame before: directions of faults then stay steady. They are what the body
        /// returned, or a copy.</summary>
        public Results<Penetration> Previous;
        /// <summary>Of steps, a share of the height; 0: 0.0001.</summary>
        public float Tolerance;
        /// <summary>Of SpherePairs().</summary>
        public Radius Radius;
        public Target Target;
    }

    /// <summary>A model in a pose. One thread at a time gives it poses and asks it; a second one gets an exception. Any number may
    /// pass it as `other`, while nobody gives it a new pose.</summary>
    public sealed unsafe class Body : IDisposable
    {
        enum Question { Penetrations, Contacts, SpherePairs, Steps, Ground }

        IntPtr handle;
        int busy;
        int readers;  // bodies that ask about this one as `other`; -1: its pose changes
        readonly IntPtr[] vertices = new IntPtr[2];  // copies: of the pose, and of the one before
        int turn;
        readonly Results<Penetration> penetrations = new Results<Penetration>(), penetrationsOfOther = new Results<Penetration>(),
                                      below = new Results<Penetration>();
        readonly Contacts contacts = new Contacts();
        readonly SpherePairs spherePairs = new SpherePairs();
        readonly Results<StepContact> steps = new Results<StepContact>();

        public Model Model { get; private set; }
        /// <summary>For calls of Native.</summary>
        public IntPtr Handle { get { return handle; } }

        /// <summary>All of its native memory is allocated here. `largestOther`: of all models that it will meet; null: none is larger
        /// than its own. Steps() needs `findsSteps`, and much memory. `maxTriangles`, `maxPenetrations`: see body.h.</summary>
        public Body(Model model, Model largestOther = null, bool findsSteps = false, int maxTriangles = 0, int maxPenetrations = 0)
        {
            Text.Require(model, Field.Asset, "the model");
            Model = model;
            Native.BodyDef def = default(Native.BodyDef);
            def.MaxTriangles = Text.Size(maxTriangles);
            def.MaxPenetrations = Text.Size(maxPenetrations);
            def.LargestOther = largestOther == null ? IntPtr.Zero : largestOther.Handle;
            def.FindsSteps = findsSteps ? 1 : 0;
            fixed (IntPtr* made = &handle) Text.Check(Native.sc_create_body(model.Handle, &def, made));
            GC.KeepAlive(model);
            GC.KeepAlive(largestOther);
        }

        /// <summary>The new pose; the old one becomes the pose before. `palette`: for each joint the skinning matrix, world times
        /// inverse bind; null with vertices alone. `place` moves it into the world, where other bodies are. `vertices`: the deformed
        /// ones, x, y, z, in the source's order. All is copied.</summary>
        public void SetPose(float[] palette, MatrixLayout layout, JointTransform? place = null, float[] morphWeights = null,
                            float[] vertices = null)
        {
            fixed (float* bones = palette, weights = morphWeights)
            {
                Native.Pose pose = palette == null ? default(Native.Pose) : Text.PoseOf(bones, palette.Length, layout);
                pose.MorphWeights = weights;
                pose.MorphWeightCount = Text.Size(morphWeights == null ? 0 : morphWeights.Length);
                SetPose(pose, place, vertices);
            }
        }

        /// <summary>From memory of an engine. Its vertices are not copied: they must stay until the next pose, and for Steps() until the
        /// one after it.</summary>
        public void SetPose(Native.Pose pose, JointTransform? place = null) { SetPose(pose, place, null); }

        void SetPose(Native.Pose pose, JointTransform? place, float[] copied)
        {
            Enter(true);
            try
            {
                if (copied != null)
                {
                    if (copied.Length / 3 < Model.VertexCount)
                    {
                        throw new SpherechainException(Code.TooSmall, Field.VertexCount, "fewer vertices than the source has");
                    }
                    turn = 1 - turn;
                    if (vertices[turn] == IntPtr.Zero) vertices[turn] = Marshal.AllocHGlobal(12 * Model.VertexCount);
                    Marshal.Copy(copied, 0, vertices[turn], 3 * Model.VertexCount);
                    pose.Vertices = (float*)vertices[turn];
                    pose.VertexCount = Text.Size(Model.VertexCount);
                }
                JointTransform to = place.GetValueOrDefault();
                Text.Check(Native.sc_set_pose(handle, &pose, place.HasValue ? &to : null));
            }
            finally { Leave(true); }
        }

        /// <summary>Which body parts are inside each other: faults first, then the deepest.</summary>
        public Results<Penetration> Penetrations(Query query = default(Query))
        {
            Ask(Question.Penetrations, null, ref query, penetrations);
            return penetrations;
        }

        /// <summary>The same of two bodies. Part is of this one.</summary>
        public Results<Penetration> Penetrations(Body other, Query query = default(Query))
        {
            Text.Require(other, Field.Bodies, "the other body");
            Ask(Question.Penetrations, other, ref query, penetrationsOfOther);
            return penetrationsOfOther;
        }

        /// <summary>Which parts are below the ground: Other is Native.Floor.</summary>
        public Results<Penetration> Below(Ground ground, Query query = default(Query))
        {
            Ask(Question.Ground, null, ref query, below, ground);
            return below;
        }

        /// <summary>Which body parts touch. Cheaper.</summary>
        public Contacts Contacts(Query query = default(Query))
        {
            Ask(Question.Contacts, null, ref query);
            return contacts;
        }

        public Contacts Contacts(Body other, Query query = default(Query))
        {
            Text.Require(other, Field.Bodies, "the other body");
            Ask(Question.Contacts, other, ref query);
            return contacts;
        }

        /// <summary>Where the spheres are, and which overlap: a cheap alarm, with false ones.</summary>
        public SpherePairs SpherePairs(Query query = default(Query))
        {
            Ask(Question.SpherePairs, null, ref query);
            return spherePairs;
        }

        /// <summary>What touches on the way from the pose before to this one. The body must be made with
        /// `findsSteps`.</summary>
        public Results<StepContact> Steps(Query query = default(Query))
        {
            Ask(Question.Steps, null, ref query);
            return steps;
        }

        public Results<StepContact> Steps(Body other, Query query = default(Query))
        {
            Text.Require(other, Field.Bodies, "the other body");
            Ask(Question.Steps, other, ref query);
            return steps;
        }

        /// <summary>A box that holds all of the skin.</summary>
        public void Bounds(out Vec3 low, out Vec3 high)
        {
            Enter(false);
            try
            {
                Vec3 from, to;
                Check(Native.sc_get_bounds(handle, &from, &to));
                low = from;
                high = to;
            }
            finally { Leave(false); }
        }

        void Ask(Question question, Body other, ref Query query, Results<Penetration> list = null, Ground ground = default(Ground))
        {
            if (other == this) throw new SpherechainException(Code.BadValue, Field.Bodies, "a body meets another one");
            CheckBits(query.IgnoredParts, Model.PartCount, Field.IgnoredParts, "a bit for each part: Model.PartSet()");
            int others = (other ?? this).Model.PartCount;
            CheckBits(query.IgnoredPartsOfOther, other == null ? 0 : others, Field.IgnoredParts, "a bit for each part: Model.PartSet()");
            CheckBits(query.PartPairs, Model.PartCount * others, Field.PartPairs, "a bit for each two parts: Model.PairSet()");
            Enter(false);
            try
            {
                if (other != null) other.BeginRead();
                try { AskNative(question, other == null ? IntPtr.Zero : other.handle, ref query, list, ground); }
                finally { if (other != null) other.EndRead(); }
            }
            finally { Leave(false); }
        }

        void AskNative(Question question, IntPtr other, ref Query query, Results<Penetration> list, Ground ground)
        {
            fixed (ulong* ignoredPairs = query.IgnoredPairs == null ? null : query.IgnoredPairs.Words)
            fixed (ulong* ignored = query.IgnoredParts, ignoredOfOther = query.IgnoredPartsOfOther, pairs = query.PartPairs)
            fixed (Penetration* previous = query.Previous == null ? null : query.Previous.Items)
            {
                Rule rule = query.Rule.GetValueOrDefault();
                Native.Query q = default(Native.Query);
                q.Scope = query.Scope;
                q.Full = query.Full ? 1 : 0;
                q.IgnoredPairs = ignoredPairs;
                q.IgnoredParts = ignored;
                q.IgnoredPartsOfOther = ignoredOfOther;
                q.PartPairs = pairs;
                q.Rule = query.Rule.HasValue ? &rule : null;
                q.Classes = query.Classes;
                q.Limit = Text.Size(query.Limit);
                q.Previous = previous;
                q.PreviousCount = Text.Size(previous == null ? 0 : query.Previous.Count);
                q.Tolerance = query.Tolerance;
                q.Radius = query.Radius;
                q.Target = query.Target;

                Status status;
                if (question == Question.Contacts)
                {
                    Native.Contacts found;
                    status = Native.sc_find_contacts(handle, other, &q, &found);
                    contacts.Parts.CopyFrom(found.Parts, found.PartCount, found.PartCount);
                    contacts.Spheres.CopyFrom(found.Spheres, found.SphereCount, found.SphereTotal);
                    contacts.Triangles.CopyFrom(found.Triangles, found.TriangleCount, found.TriangleTotal);
                }
                else if (question == Question.SpherePairs)
                {
                    Native.SpherePairs found;
                    status = Native.sc_find_sphere_pairs(handle, &q, &found);
                    spherePairs.Spheres.CopyFrom(found.Spheres, found.SphereCount, found.SphereCount);
                    spherePairs.Pairs.CopyFrom(found.Pairs, found.Count, found.Total);
                }
                else if (question == Question.Steps)
                {
                    StepContact* found;
                    UIntPtr count;
                    status = Native.sc_find_steps(handle, other, &q, &found, &count);
                    steps.CopyFrom(found, count, count);
                }
                else
                {
                    Native.Penetrations found;
                    Native.Ground plane = default(Native.Ground);
                    plane.Up = ground.Up;
                    plane.Height = ground.Height;
                    status = question == Question.Ground ? Native.sc_find_in_ground(handle, &plane, &q, &found)
                                                         : Native.sc_find_penetrations(handle, other, &q, &found);
                    list.CopyFrom(found.Items, found.Count, found.Total);
                }
                Check(status);
            }
        }

        internal static void CheckBits(ulong[] words, int bits, Field field, string remedy)
        {
            if (words != null && words.Length < (bits + 63) / 64) throw new SpherechainException(Code.TooSmall, field, remedy);
        }

        static void Check(Status status)
        {
            string text = status.Field != Field.Bodies ? null
                : status.Code == Code.NotOpen ? "a body has no pose: SetPose(); a step needs two"
                : status.Code == Code.TooSmall ? "the body was made without findsSteps, or for a smaller other model" : null;
            if (text != null) throw new SpherechainException(status.Code, status.Field, text);
            Text.Check(status);
        }

        static SpherechainException InUse()
        {
            return new SpherechainException(Code.Aliased, Field.Bodies, "the body is in use: make one a thread");
        }

        internal void Enter(bool changesPose)
        {
            if (Interlocked.CompareExchange(ref busy, 1, 0) != 0) throw InUse();
            try
            {
                CheckOpen();
                if (changesPose && Interlocked.CompareExchange(ref readers, -1, 0) != 0) throw InUse();
            }
            catch
            {
                Volatile.Write(ref busy, 0);
                throw;
            }
        }

        internal void Leave(bool changesPose)
        {
            if (changesPose) Volatile.Write(ref readers, 0);
            Volatile.Write(ref busy, 0);
            GC.KeepAlive(this);
        }

        internal void BeginRead()
        {
            for (int now = 0, last = -1; now != last;)
            {
                last = Volatile.Read(ref readers);
                if (last < 0) throw InUse();
                now = Interlocked.CompareExchange(ref readers, last + 1, last);
            }
            try { CheckOpen(); }
            catch
            {
                EndRead();
                throw;
            }
        }

        internal void EndRead()
        {
            Interlocked.Decrement(ref readers);
            GC.KeepAlive(this);
        }

        void CheckOpen()
        {
            if (handle != IntPtr.Zero && Model.Handle != IntPtr.Zero) return;
            throw new SpherechainException(Code.NotOpen, Field.Bodies, "the body is disposed");
        }

        public void Dispose()
        {
            if (handle == IntPtr.Zero) return;
            if (Interlocked.CompareExchange(ref busy, 1, 0) != 0) throw InUse();
            bool isRead = Interlocked.CompareExchange(ref readers, -1, 0) != 0;
            if (!isRead) Free();
            Leave(!isRead);
            if (isRead) throw InUse();
            GC.SuppressFinalize(this);
        }

        void Free()
        {
            if (handle != IntPtr.Zero) Native.sc_destroy_body(handle);
            handle = IntPtr.Zero;
            for (int i = 0; i < 2; ++i)
            {
                Marshal.FreeHGlobal(vertices[i]);
                vertices[i] = IntPtr.Zero;
            }
        }

        ~Body() { Free(); }
    }
}
