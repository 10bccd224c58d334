// SPDX-License-Identifier: MIT
// Two bodies of Spherechain.Body.cs, or one of them and a prop.
using System;

namespace Spherechain
{
    /// <summary>Where two bodies, placed in one space, penetrate each other. A and B may be of one asset, not the same body.</summary>
    public sealed unsafe class BodyPair : IDisposable
    {
        Memory scratch;
        PartContact[] contacts = new PartContact[256];
        TriangleContact[] triangles = new TriangleContact[4096];
        Penetration[] penetrations = new Penetration[256];

        public Body A { get; private set; }
        public Body B { get; private set; }
        /// <summary>Of the last FindContacts(): the first ContactCount, TriangleCount. PartA is A's, PartB is B's.</summary>
        public PartContact[] Contacts { get { return contacts; } }
        public int ContactCount { get; private set; }
        public TriangleContact[] Triangles { get { return triangles; } }
        public int TriangleCount { get; private set; }
        /// <summary>Of the last MeasurePenetrations(): the first PenetrationCount. Part is A's, Other is B's.</summary>
        public Penetration[] Penetrations { get { return penetrations; } }
        public int PenetrationCount { get; private set; }

        public BodyPair(Body a, Body b)
        {
            Text.Require(a, Field.Bodies, "body A");
            Text.Require(b, Field.Bodies, "body B");
            if (a == b) throw new SpherechainException(Code.BadValue, Field.Bodies, "a body meets another one: see Body.FindContacts()");
            A = a;
            B = b;
            scratch = new Memory(8 * checked((long)Native.sc_body_scratch_words(a.Asset.Open(), b.Asset.Open()).ToUInt64()));
        }

        /// <summary>Which parts of A and B intersect, exactly. Returns ContactCount.</summary>
        public int FindContacts()
        {
            Native.JobBody a, b;
            Enter(out a, out b);
            try
            {
                Room(Native.sc_body_scratch_words(a.Asset, b.Asset));
                for (;;)
                {
                    fixed (PartContact* parts = contacts)
                    fixed (TriangleContact* found = triangles)
                    {
                        Native.BodyContactJob job = default(Native.BodyContactJob);
                        job.A = a;
                        job.B = b;
                        job.Scratch = scratch.Words;
                        job.ScratchWords = scratch.WordCount;
                        job.Parts = parts;
                        job.PartCapacity = Text.Size(contacts.Length);
                        job.Triangles = found;
                        job.TriangleCapacity = Text.Size(triangles.Length);
                        Status status = Native.sc_find_body_contacts(&job);
                        if (status.Code != Code.Overflow) Text.Check(status);
                        ContactCount = Text.Int(job.PartCount);
                        TriangleCount = Text.Int(job.TriangleCount);
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

        /// <summary>How deep what the last FindContacts() of these poses found is. Returns PenetrationCount.</summary>
        public int MeasurePenetrations(bool quick)
        {
            PenetrationCount = 0;
            Native.JobBody a, b;
            Enter(out a, out b);
            try
            {
                Room(Native.sc_body_penetration_scratch_words(a.Asset, b.Asset, Text.Size(TriangleCount)));
                for (;;)
                {
                    int count;
                    fixed (TriangleContact* found = triangles)
                    fixed (Penetration* measures = penetrations)
                    {
                        Native.BodyPenetrationJob job = default(Native.BodyPenetrationJob);
                        job.A = a;
                        job.B = b;
                        job.Contacts = found;
                        job.ContactCount = Text.Size(TriangleCount);
                        job.Quick = quick ? 1 : 0;
                        job.Scratch = scratch.Words;
                        job.ScratchWords = scratch.WordCount;
                        job.Penetrations = measures;
                        job.PenetrationCapacity = Text.Size(penetrations.Length);
                        Status status = Native.sc_measure_body_penetrations(&job);
                        if (status.Code != Code.Overflow) Text.Check(status);
                        count = Text.Int(job.PenetrationCount);
                        if (status.Code == Code.Ok) return PenetrationCount = count;
                    }
                    Lists.Grow(ref penetrations, count);
                }
            }
            finally { Leave(); }
        }

        void Enter(out Native.JobBody a, out Native.JobBody b)
        {
            if (scratch.Data == null) throw new SpherechainException(Code.NotOpen, Field.Bodies, "the pair is disposed");
            a = A.View(A.Enter(true));
            try { b = B.View(B.Enter(true)); }
            catch
            {
                A.Leave();
                throw;
            }
        }

        void Leave()
        {
            A.Leave();
            B.Leave();
            GC.KeepAlive(this);
        }

        void Room(UIntPtr words)
        {
            if (words.ToUInt64() <= scratch.WordCount.ToUInt64()) return;
            scratch.Dispose();
            scratch = new Memory(8 * checked((long)words.ToUInt64()));
        }

        /// <summary>Of the pair's own memory; the bodies stay.</summary>
        public void Dispose() { if (scratch.Data != null) scratch.Dispose(); }
    }
}
