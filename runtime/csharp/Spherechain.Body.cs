// SPDX-License-Identifier: MIT
// The longer way: a Body is one character with its pose and working memory. Spheres, pairs of spheres, contacts of the skin,
// their depth, the ground. Lists grow to the largest frame so far and stay: then nothing is allocated.
using System;
using System.Threading;

namespace Spherechain
{
    /// <summary>One character. One thread at a time; bodies of one Asset may work side by side. Bodies of one asset cost a
    /// table of its skin each, of about the size of the asset.</summary>
    public sealed unsafe class Body : IDisposable
    {
        readonly Memory bones, table, skin, ignored;
        Memory scratch;
        readonly uint[] jointOfBone;  // null: palettes come in the asset's order
        bool isPosed;
        int busy;

        public Asset Asset { get; private set; }
        /// <summary>Of the last Refit(): Asset.SphereCount of them, in the pose's space.</summary>
        public Sphere[] Spheres { get; private set; }
        /// <summary>Of the last Detect(): the first PairCount, of spheres, sorted.</summary>
        public Pair[] Pairs { get; private set; }
        public int PairCount { get; private set; }
        /// <summary>Of the last FindContacts(): the first ContactCount pairs of parts, TriangleCount pairs of triangles.</summary>
        public PartContact[] Contacts { get { return contacts; } }
        public int ContactCount { get; private set; }
        public TriangleContact[] Triangles { get { return triangles; } }
        public int TriangleCount { get; private set; }
        /// <summary>Of the last MeasurePenetrations() or FindFloor(): the first PenetrationCount.</summary>
        public Penetration[] Penetrations { get { return penetrations; } }
        public int PenetrationCount { get; private set; }

        PartContact[] contacts;
        TriangleContact[] triangles;
        Penetration[] penetrations;

        /// <summary>`asset` must stay until the body is disposed. `joints` and `inverseBinds`: as for a Character.</summary>
        public Body(Asset asset, string[] joints = null, float[] inverseBinds = null, MatrixLayout layout = MatrixLayout.LayoutUnset)
        {
            Text.Require(asset, Field.Asset, "the asset");
            Asset = asset;
            Native.Asset* view = asset.Open();
            if (joints != null)
            {
                jointOfBone = new uint[asset.BoneCount];
                byte* message = stackalloc byte[Text.MessageSize];
                message[0] = 0;
                using (Joints taken = new Joints(joints, inverseBinds, layout))
                {
                    fixed (uint* of = jointOfBone)
                    {
                        Text.Check(Native.sc_bind_joints(view, taken.Bones, Text.Size(taken.Count),
                                                         inverseBinds == null ? MatrixLayout.Columns4x4 : layout, of,
                                                         Text.Size(jointOfBone.Length), message, Text.Size(Text.MessageSize)),
                                   message);
                    }
                }
            }
            bones = new Memory(12L * 4 * asset.BoneCount);
            table = Words(Native.sc_detect_table_words(view));
            Text.Check(Native.sc_prepare_detect(view, Radius.Detect, null, table.Words, table.WordCount));
            if (Native.sc_skin_table_words(view) != UIntPtr.Zero)
            {
                skin = Words(Native.sc_skin_table_words(view));
                Text.Check(Native.sc_prepare_skin(view, skin.Words, skin.WordCount));
            }
            ignored = Words(Native.sc_part_words(view));
            scratch = Words(Native.sc_skin_scratch_words(view));
            Spheres = new Sphere[asset.SphereCount];
            Pairs = new Pair[asset.SphereCount * (asset.SphereCount - 1) / 2];
            int pairs = asset.PartCount * (asset.PartCount + 1) / 2;
            contacts = new PartContact[pairs];
            penetrations = new Penetration[pairs];
            triangles = new TriangleContact[4096];
            GC.KeepAlive(asset);
        }

        /// <summary>A part that meets nothing, in a BodyPair: a hand that holds the other body.</summary>
        public void IgnorePart(int part, bool isIgnored)
        {
            if (ignored.Data == null) throw new SpherechainException(Code.NotOpen, Field.Asset, "the body is disposed");
            if (part < 0 || part >= Asset.PartCount) throw new SpherechainException(Code.BadValue, Field.Index, "no part " + part);
            ulong bit = 1ul << (part % 64);
            if (isIgnored) ignored.Words[part / 64] |= bit;
            else ignored.Words[part / 64] &= ~bit;
        }

        /// <summary>Takes a frame's palette: a skinning matrix for each joint. All that follows is of this pose.</summary>
        public void SetPalette(float[] palette, MatrixLayout layout)
        {
            Text.Require(palette, Field.Bones, "the palette");
            fixed (float* first = palette) SetPalette(first, palette.Length / Joints.Floats(layout), layout);
        }

        public void SetPalette(float* palette, int count, MatrixLayout layout)
        {
            Native.Asset* view = Enter(false);
            try
            {
                isPosed = false;
                PairCount = ContactCount = TriangleCount = PenetrationCount = 0;
                Native.Pose pose = Character.PoseOf(palette, count, layout);
                if (jointOfBone != null)
                {
                    fixed (uint* of = jointOfBone) Text.Check(Native.sc_gather_bones(view, of, &pose, (float*)bones.Data));
                }
                else
                {
                    Copy(palette, count, layout);
                }
                isPosed = true;
            }
            finally { Leave(); }
        }

        void Copy(float* palette, int count, MatrixLayout layout)
        {
            if (palette == null || count < Asset.BoneCount)
            {
                throw new SpherechainException(palette == null ? Code.Null : Code.TooSmall, palette == null ? Field.Bones : Field.BoneCount,
                                               "the palette has fewer matrices than the asset has bones");
            }
            int floats = Joints.Floats(layout);
            bool byRows = layout == MatrixLayout.Rows3x4 || layout == MatrixLayout.Rows4x4;
            int height = layout == MatrixLayout.Columns3x4 ? 3 : 4;
            float* to = (float*)bones.Data;
            for (int bone = 0; bone < Asset.BoneCount; ++bone, palette += floats)
            {
                for (int row = 0; row < 3; ++row)
                {
                    for (int column = 0; column < 4; ++column) *to++ = palette[byRows ? 4 * row + column : height * column + row];
                }
            }
        }

        /// <summary>Moves the pose from the character's own space into the world, where the other body is. No scale: the
        /// classes of penetrations compare with the character's height.</summary>
        public void Place(JointTransform transform)
        {
            Enter(true);
            PairCount = ContactCount = TriangleCount = PenetrationCount = 0;
            try { Text.Check(Native.sc_place_bones(&transform, (float*)bones.Data, Text.Size(Asset.BoneCount))); }
            finally { Leave(); }
        }

        /// <summary>Where the spheres are: Spheres.</summary>
        public void Refit()
        {
            Native.Asset* view = Enter(true);
            try { RefitIn(view); }
            finally { Leave(); }
        }

        void RefitIn(Native.Asset* view)
        {
            fixed (Sphere* spheres = Spheres)
            {
                Native.RefitJob job = default(Native.RefitJob);
                job.Asset = view;
                job.Pose = Pose;
                job.Spheres = spheres;
                job.SphereCapacity = Text.Size(Spheres.Length);
                Text.Check(Native.sc_refit(&job));
            }
        }

        /// <summary>Refit(), and which spheres touch: a cheap alarm, with false ones. Returns PairCount.</summary>
        public int Detect()
        {
            Native.Asset* view = Enter(true);
            try
            {
                RefitIn(view);
                fixed (Sphere* spheres = Spheres)
                fixed (Pair* pairs = Pairs)
                {
                    Native.DetectJob job = default(Native.DetectJob);
                    job.Asset = view;
                    job.Spheres = spheres;
                    job.SphereCount = Text.Size(Spheres.Length);
                    job.Table = table.Words;
                    job.Pairs = pairs;
                    job.PairCapacity = Text.Size(Pairs.Length);
                    Text.Check(Native.sc_detect(&job));
                    return PairCount = Text.Int(job.PairCount);
                }
            }
            finally { Leave(); }
        }

        /// <summary>Where the skin intersects itself, exactly: Contacts and Triangles. Returns ContactCount. Scope.Apart leaves
        /// the folds at joints out.</summary>
        public int FindContacts(Scope scope)
        {
            Native.Asset* view = Enter(true);
            try
            {
                Room(Native.sc_skin_scratch_words(view));
                for (;;)
                {
                    fixed (PartContact* parts = contacts)
                    fixed (TriangleContact* found = triangles)
                    {
                        Native.SkinContactJob job = default(Native.SkinContactJob);
                        job.Asset = view;
                        job.Pose = Pose;
                        job.Scope = scope;
                        job.SkinTable = Skin;
                        job.Scratch = scratch.Words;
                        job.ScratchWords = scratch.WordCount;
                        job.Parts = parts;
                        job.PartCapacity = Text.Size(contacts.Length);
                        job.Triangles = found;
                        job.TriangleCapacity = Text.Size(triangles.Length);
                        Status status = Native.sc_find_skin_contacts(&job);
                        if (status.Code != Code.Overflow) Text.Check(status);
                        ContactCount = Text.Int(job.PartCount);
                        TriangleCount = Text.Int(job.TriangleCount);
                        measured = scope;
                        if (status.Code == Code.Ok) return ContactCount;
                    }
                    Lists.Grow(ref contacts, ContactCount);
                    Lists.Grow(ref triangles, TriangleCount);
                }
            }
            catch
            {
                ContactCount = TriangleCount = 0;
                throw;
            }
            finally { Leave(); }
        }

        Scope measured;

        /// <summary>How deep what the last FindContacts() of this pose found is, and which way out: Penetrations. `quick`: as a
        /// Character measures, only likely faults in full; else everything in full, with volumes. Returns PenetrationCount.</summary>
        public int MeasurePenetrations(bool quick)
        {
            PenetrationCount = 0;
            Native.Asset* view = Enter(true);
            try
            {
                Room(Native.sc_penetration_scratch_words(view, Text.Size(TriangleCount)));
                for (;;)
                {
                    int count;
                    fixed (TriangleContact* found = triangles)
                    fixed (Penetration* measures = penetrations)
                    {
                        Native.PenetrationJob job = default(Native.PenetrationJob);
                        job.Asset = view;
                        job.Pose = Pose;
                        job.Scope = measured;
                        job.SkinTable = Skin;
                        job.Contacts = found;
                        job.ContactCount = Text.Size(TriangleCount);
                        job.Quick = quick ? 1 : 0;
                        job.Scratch = scratch.Words;
                        job.ScratchWords = scratch.WordCount;
                        job.Penetrations = measures;
                        job.PenetrationCapacity = Text.Size(penetrations.Length);
                        Status status = Native.sc_measure_penetrations(&job);
                        if (status.Code != Code.Overflow) Text.Check(status);
                        count = Text.Int(job.PenetrationCount);
                        if (status.Code == Code.Ok) return PenetrationCount = count;
                    }
                    Lists.Grow(ref penetrations, count);
                }
            }
            finally { Leave(); }
        }

        /// <summary>Which parts are below the plane up . p = height, and how deep: Penetrations, with Other Native.Floor.
        /// Returns PenetrationCount.</summary>
        public int FindFloor(Vec3 up, float height)
        {
            PenetrationCount = 0;
            Native.Asset* view = Enter(true);
            try
            {
                Room(Native.sc_floor_scratch_words(view));
                fixed (Penetration* measures = penetrations)  // a part is there once: there is room
                {
                    Native.FloorJob job = default(Native.FloorJob);
                    job.Body = View(view);
                    job.Up = up;
                    job.Height = height;
                    job.Scratch = scratch.Words;
                    job.ScratchWords = scratch.WordCount;
                    job.Penetrations = measures;
                    job.PenetrationCapacity = Text.Size(penetrations.Length);
                    Text.Check(Native.sc_find_floor_penetrations(&job));
                    return PenetrationCount = Text.Int(job.PenetrationCount);
                }
            }
            finally { Leave(); }
        }

        internal Native.JobBody View(Native.Asset* view)
        {
            Native.JobBody body = default(Native.JobBody);
            body.Asset = view;
            body.Pose = Pose;
            body.SkinTable = Skin;
            body.IgnoredParts = ignored.Words;
            return body;
        }

        Native.Pose Pose { get { return Character.PoseOf((float*)bones.Data, Asset.BoneCount, MatrixLayout.Rows3x4); } }
        ulong* Skin { get { return skin == null ? null : skin.Words; } }

        void Room(UIntPtr words)
        {
            if (words.ToUInt64() <= scratch.WordCount.ToUInt64()) return;
            scratch.Dispose();
            scratch = Words(words);
        }

        static Memory Words(UIntPtr words) { return new Memory(8 * checked((long)words.ToUInt64())); }

        internal Native.Asset* Enter(bool needsPose)
        {
            if (Interlocked.CompareExchange(ref busy, 1, 0) != 0)
            {
                throw new SpherechainException(Code.Aliased, Field.Scratch, "the body is in use: make one a thread");
            }
            try
            {
                if (bones.Data == null) throw new SpherechainException(Code.NotOpen, Field.Asset, "the body is disposed");
                if (needsPose && !isPosed) throw new SpherechainException(Code.Null, Field.Bones, "the body has no pose: SetPalette()");
                return Asset.Open();
            }
            catch
            {
                Volatile.Write(ref busy, 0);
                throw;
            }
        }

        internal void Leave()
        {
            Volatile.Write(ref busy, 0);
            GC.KeepAlive(this);
        }

        public void Dispose()
        {
            if (bones.Data == null) return;
            if (Interlocked.CompareExchange(ref busy, 1, 0) != 0)
            {
                throw new SpherechainException(Code.Aliased, Field.Scratch, "the body is in use by another thread");
            }
            bones.Dispose();
            table.Dispose();
            if (skin != null) skin.Dispose();
            ignored.Dispose();
            scratch.Dispose();
            Volatile.Write(ref busy, 0);
        }
    }

    internal static class Lists
    {
        internal static void Grow<T>(ref T[] list, int count)
        {
            if (count > list.Length) list = new T[Math.Max(count, 2 * list.Length)];
        }
    }
}
